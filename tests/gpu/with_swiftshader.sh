#!/bin/sh
# with_swiftshader.sh PROGRAM [ARGUMENT...]: runs a program with one Vulkan driver, the SwiftShader of Debian's
# Chromium. Without Chromium the exit status is 77: ctest counts the test as skipped.
driver=/usr/lib/chromium/vk_swiftshader_icd.json
if [ ! -f "$driver" ]; then
    echo "Skipped: there is no $driver. Debian's package chromium has it." >&2
    exit 77
fi
VK_DRIVER_FILES=$driver exec "$@"
