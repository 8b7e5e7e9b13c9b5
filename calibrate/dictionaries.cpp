// SPDX-License-Identifier: Apache-2.0
#include "calibrate/dictionaries.h"

#include "formats/files/error.h"

#include <opencv2/aruco/dictionary.hpp>

#include <algorithm>
#include <array>
#include <utility>

namespace nearfield::calibrate {
namespace {

constexpr std::array<std::pair<const char*, int>, 17> kDictionaries = {{
    {"4x4_50", cv::aruco::DICT_4X4_50},
    {"4x4_100", cv::aruco::DICT_4X4_100},
    {"4x4_250", cv::aruco::DICT_4X4_250},
    {"4x4_1000", cv::aruco::DICT_4X4_1000},
    {"5x5_50", cv::aruco::DICT_5X5_50},
    {"5x5_100", cv::aruco::DICT_5X5_100},
    {"5x5_250", cv::aruco::DICT_5X5_250},
    {"5x5_1000", cv::aruco::DICT_5X5_1000},
    {"6x6_50", cv::aruco::DICT_6X6_50},
    {"6x6_100", cv::aruco::DICT_6X6_100},
    {"6x6_250", cv::aruco::DICT_6X6_250},
    {"6x6_1000", cv::aruco::DICT_6X6_1000},
    {"7x7_50", cv::aruco::DICT_7X7_50},
    {"7x7_100", cv::aruco::DICT_7X7_100},
    {"7x7_250", cv::aruco::DICT_7X7_250},
    {"7x7_1000", cv::aruco::DICT_7X7_1000},
    {"original", cv::aruco::DICT_ARUCO_ORIGINAL},
}};

}  // namespace

int opencv_dictionary(const std::string& name) {
    const auto found = std::find_if(kDictionaries.begin(), kDictionaries.end(),
                                    [&](const auto& entry) { return name == entry.first; });
    if (found == kDictionaries.end())
        throw Error{"cannot look for the board", "dictionary", "4x4_50 ... 7x7_1000, original",
                    "'" + name + "'"};
    return found->second;
}

}  // namespace nearfield::calibrate
