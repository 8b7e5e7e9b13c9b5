// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace nearfield::calibrate {

/// OpenCV's number of a marker dictionary, named as in plans: "5x5_100". Throws Error for others.
int opencv_dictionary(const std::string& name);

}  // namespace nearfield::calibrate
