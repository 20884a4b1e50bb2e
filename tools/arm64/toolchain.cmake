# Builds for arm64 on this machine (docs/arm64.md): Debian's cross compiler, everything else from the root folder that
# tools/arm64/make-sysroot makes, programs run by QEMU. Generators (lcm-gen, protoc, python3) are this machine's own.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(STILLCUT_SYSROOT ${CMAKE_CURRENT_LIST_DIR}/../../build-arm64/sysroot CACHE PATH "Root folder made by make-sysroot")
cmake_path(NORMAL_PATH STILLCUT_SYSROOT)
list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES STILLCUT_SYSROOT)
set(CMAKE_SYSROOT ${STILLCUT_SYSROOT})
set(CMAKE_C_COMPILER aarch64-linux-gnu-gcc)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
set(CMAKE_LIBRARY_ARCHITECTURE aarch64-linux-gnu)
set(CMAKE_CXX_FLAGS_INIT -Wno-psabi)  # no notes that calls were other ones before GCC 10
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-aarch64-static -L ${STILLCUT_SYSROOT})

set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(ENV{PKG_CONFIG_PATH} "")
set(ENV{PKG_CONFIG_LIBDIR} ${STILLCUT_SYSROOT}/usr/lib/aarch64-linux-gnu/pkgconfig:${STILLCUT_SYSROOT}/usr/share/pkgconfig)
set(ENV{PKG_CONFIG_SYSROOT_DIR} ${STILLCUT_SYSROOT})

set(CPACK_DEBIAN_PACKAGE_ARCHITECTURE arm64)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS
  ${STILLCUT_SYSROOT}/usr/lib/aarch64-linux-gnu ${STILLCUT_SYSROOT}/lib/aarch64-linux-gnu)
