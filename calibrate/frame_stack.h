// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "calibrate/pixel_layout.h"
#include "formats/capture/frame.h"
#include "formats/capture/records.h"

#include <functional>
#include <vector>

namespace nearfield::calibrate {

/// Gives a frame's values: from a capture's folder, or from a camera that is computed.
using FrameReader = std::function<capture::Frame(const capture::FrameRecord&)>;

/// Frames of one kind and one exposure.
struct ExposureGroup {
    double exposure_us = 0;
    std::vector<const capture::FrameRecord*> frames;  // by shot number
};

/// Mean and spread of frames, value by value; takes one frame at a time (Welford 1962).
struct FrameStack {
    int count = 0;
    std::vector<float> mean_dn;
    std::vector<float> squares_dn2;  // sum of squared distances from the mean

    void add(const capture::Frame& frame);
};

/// Reads and sums a group. Cost: one frame in memory besides the stack.
FrameStack stack_of(const ExposureGroup& group, const PixelLayout& layout, const FrameReader& read);

/// Mean variance of one value of one frame, DN^2, noisy values left out (beyond 16 times the
/// median). Zero for a single frame.
double mean_variance_dn2(const FrameStack& stack);

}  // namespace nearfield::calibrate
