/* version.h - the version every program reports; the same as CMake's project version and the CHANGELOG's newest entry. */
#ifndef PELORUS_TOOLS_VERSION_H
#define PELORUS_TOOLS_VERSION_H

#define PELORUS_VERSION "0.1.0"

#endif
