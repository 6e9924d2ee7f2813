# Compiler flags of the whole tree. Bit-identical results need -ffp-contract=off everywhere; -fno-math-errno lets a square
# root be one instruction.
set(CMAKE_C_FLAGS_RELWITHDEBINFO "-O2 -g")
set(CMAKE_CXX_FLAGS_RELWITHDEBINFO "-O2 -g")

set(PEL_FLAGS -ffp-contract=off -fno-math-errno)
set(PEL_WARNINGS -Wall -Wextra -Wconversion -Wshadow)
set(PEL_C_WARNINGS ${PEL_WARNINGS} -Wdouble-promotion)

# Flags of a firmware target: strict C11, no extensions, every warning an error.
function(pel_firmware_flags target)
    set_target_properties(${target} PROPERTIES C_EXTENSIONS OFF)
    target_compile_options(${target} PRIVATE ${PEL_FLAGS} ${PEL_C_WARNINGS} -Werror)
    if(CMAKE_CROSSCOMPILING)
        # Enums are unsigned bytes there: "below zero?" is a check on other machines and a tautology on this one.
        target_compile_options(${target} PRIVATE -Wno-type-limits)
    endif()
endfunction()

# Flags of a desktop target: POSIX is there, doubles are free, C++ is allowed.
function(pel_host_flags target)
    target_compile_options(${target} PRIVATE ${PEL_FLAGS} ${PEL_WARNINGS})
    if(PEL_WERROR_ALL)
        target_compile_options(${target} PRIVATE -Werror)
    endif()
endfunction()
