// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "formats/photos/photo.h"

#include <string>

/// What the module gives: reads a photograph, or says why not. Both sides are built together, so
/// that C++ types may pass.
extern "C" bool nearfield_read_photo(const std::string& path,
                                     nearfield::photos::Photo& photo,
                                     std::string& complaint);

/// The same of a picture of light.
extern "C" bool nearfield_read_radiance(const std::string& path,
                                        nearfield::photos::RadiancePicture& picture,
                                        std::string& complaint);
