# Outside packages of the desktop build. cmake/bootstrap.sh brings them; a plain `cmake -B somewhere` calls it too.
set(PEL_DEPS_DIR ${CMAKE_SOURCE_DIR}/build/deps CACHE PATH "Where bootstrap.sh puts what it fetches")
set(UNITY_DIR ${PEL_DEPS_DIR}/unity CACHE PATH "Source tree of the Unity test framework")
option(PEL_BOOTSTRAP "Run cmake/bootstrap.sh when configuring" ON)

if(PEL_BOOTSTRAP)
    execute_process(COMMAND ${CMAKE_COMMAND} -E env PEL_DEPS_DIR=${PEL_DEPS_DIR} ${CMAKE_SOURCE_DIR}/cmake/bootstrap.sh host
                    RESULT_VARIABLE failed)
    if(failed)
        message(FATAL_ERROR "cmake/bootstrap.sh could not bring everything the build needs (see above)")
    endif()
endif()

set(PEL_VENV ${PEL_DEPS_DIR}/venv)
set(PEL_PYTHON ${PEL_VENV}/bin/python)
execute_process(COMMAND ${PEL_PYTHON} -c "import sysconfig; print(sysconfig.get_paths()['purelib'])"
                OUTPUT_VARIABLE PEL_SITE_PACKAGES OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)

find_package(PkgConfig REQUIRED)
find_package(ZLIB REQUIRED)
find_package(Threads REQUIRED)
pkg_check_modules(GLIB2 REQUIRED IMPORTED_TARGET glib-2.0)

# LCM's CMake package wants GLib2::glib defined before it is found.
add_library(GLib2::glib INTERFACE IMPORTED)
set_target_properties(GLib2::glib PROPERTIES INTERFACE_LINK_LIBRARIES PkgConfig::GLIB2)
list(PREPEND CMAKE_PREFIX_PATH ${PEL_SITE_PACKAGES})
find_package(lcm 1.5 REQUIRED)
include(${LCM_USE_FILE})

add_library(unity STATIC EXCLUDE_FROM_ALL ${UNITY_DIR}/src/unity.c)
target_include_directories(unity SYSTEM PUBLIC ${UNITY_DIR}/src)
target_compile_definitions(unity PUBLIC UNITY_INCLUDE_DOUBLE UNITY_SUPPORT_64)
