// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>

namespace nearfield::acquire {

/// A line of an exposure list.
struct ListedExposure {
    double exposure_us = 0;
    double f_number = 0;
};

/// Reads a list as Debevec's programs wrote them: a count of pictures, then for each its file name,
/// 1 / shutter speed in s, f-stop, gain in dB, ND filters; # begins a remark. By file name without
/// extension, which lists and folders often have another of. Throws Error with the line where it
/// says something else.
std::map<std::string, ListedExposure> read_exposure_list(const std::string& path);

/// The folder's list, NAME.hdr_image_list.txt, if there is one.
std::optional<std::string> find_exposure_list(const std::string& folder);

}  // namespace nearfield::acquire
