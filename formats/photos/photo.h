// SPDX-License-Identifier: Apache-2.0
/// Photographs of other people's cameras (PNG, JPEG, TIFF and raw files) and pictures of light
/// (Radiance .hdr).
///
/// OpenImageIO, which reads them, brings 260 shared libraries that take 0.2 s to load. So it stands
/// in a module of its own, opened when the first photograph is read; no other command pays for it.
#pragma once

#include "formats/capture/frame.h"

#include <glm/glm.hpp>

#include <optional>
#include <string>
#include <vector>

namespace nearfield::photos {

struct Photo {
    capture::Frame frame;                              // 1 or 3 channels; transparency is left out
    std::string format;                                // by its content: "jpeg", "png", "raw"
    bool is_linear = false;                            // raw files: values follow light
    std::string make, model;                           // of the camera, by EXIF
    std::optional<double> exposure_us, f_number, iso;  // by EXIF
};

/// Throws Error if the file is no picture, is damaged, or holds floating point or more than 2^28
/// pixels.
Photo read_photo(const std::string& path);

/// Light as other people's programs store it, up to a factor.
struct RadiancePicture {
    glm::ivec2 size_px{0};
    std::vector<glm::vec3> rgb;  // [row from the top][column]; linear; one channel gives it thrice
};

/// Reads a Radiance file (.hdr). Throws Error if the file is none, is damaged, or holds more than
/// 2^28 pixels.
RadiancePicture read_radiance(const std::string& path);

}  // namespace nearfield::photos
