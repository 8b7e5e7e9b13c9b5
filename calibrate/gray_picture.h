// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "formats/capture/frame.h"

#include <opencv2/core.hpp>

#include <string>

namespace nearfield::calibrate {

/// A frame as gray for finding corners: positions are the frame's own.
struct GrayPicture {
    cv::Mat values;     // float, 0 at the darkest per cent of the pixels, 255 at the brightest
    cv::Mat stretched;  // the same in 8 bits, cut off at both ends
};

/// Pixels of a mosaic are weighed by color so that gray things are even: all of them keep their
/// places, and no interpolation blurs or shifts an edge. Throws Error for an unknown mosaic.
GrayPicture gray_picture(const capture::Frame& frame, const std::string& mosaic);

}  // namespace nearfield::calibrate
