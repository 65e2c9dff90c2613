# Copyright (c) 2026 The scanlock authors
# SPDX-License-Identifier: MIT
#
# Builds for arm64 on another Debian machine; tools/package/arm64_sysroot --help shows how.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_C_COMPILER aarch64-linux-gnu-gcc)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
set(CMAKE_STRIP aarch64-linux-gnu-strip)
set(CMAKE_LIBRARY_ARCHITECTURE aarch64-linux-gnu)
set(SCANLOCK_SYSROOT "" CACHE PATH "What arm64_sysroot filled")
list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES SCANLOCK_SYSROOT)

set(libraries ${SCANLOCK_SYSROOT}/usr/lib/aarch64-linux-gnu)
set(CMAKE_FIND_ROOT_PATH ${SCANLOCK_SYSROOT})
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE BOTH)
set(CMAKE_EXE_LINKER_FLAGS_INIT "-Wl,-rpath-link,${libraries} -Wl,-rpath-link,${SCANLOCK_SYSROOT}/lib/aarch64-linux-gnu")

find_program(SCANLOCK_QEMU NAMES qemu-aarch64-static qemu-aarch64)
if(SCANLOCK_QEMU)
  set(CMAKE_CROSSCOMPILING_EMULATOR ${SCANLOCK_QEMU};-L;/usr/aarch64-linux-gnu;-E
    LD_LIBRARY_PATH=${libraries}:${SCANLOCK_SYSROOT}/lib/aarch64-linux-gnu)
endif()
