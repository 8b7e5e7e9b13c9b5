// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>

namespace nearfield {

/// The world is wrong: a file, an option's value, a device. Thrown anywhere, caught once, in main.
///
/// what      what failed, in the user's words: "cannot read ray file"
/// where     file and place in it: "led.tm25ray, byte 36288, ray 17"
/// expected  what would have been right; empty where what and where say it all
/// got       what was found instead
struct Error : std::runtime_error {
    Error(std::string what_failed,
          std::string where_found,
          std::string expected_value = {},
          std::string got_value = {});

    std::string what_, where, expected, got;
};

/// What the system's last failed call says of itself (errno): "No such file or directory".
std::string system_error();

}  // namespace nearfield
