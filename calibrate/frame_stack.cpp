// SPDX-License-Identifier: Apache-2.0
#include "calibrate/frame_stack.h"

#include "calibrate/robust.h"

namespace nearfield::calibrate {
namespace {

// Of values that are normal, and three frames or more, 1e-3 lie beyond: 1 % of the mean at worst.
constexpr float kMostOverMedian = 16.0F;

}  // namespace

void FrameStack::add(const capture::Frame& frame) {
    if (count == 0) {
        mean_dn.assign(frame.values.size(), 0.0F);
        squares_dn2.assign(frame.values.size(), 0.0F);
    }
    ++count;
    const float share = 1.0F / static_cast<float>(count);
    for (std::size_t k = 0; k < frame.values.size(); ++k) {
        const auto value = static_cast<float>(frame.values[k]);
        const float from_old = value - mean_dn[k];
        mean_dn[k] += share * from_old;
        squares_dn2[k] += from_old * (value - mean_dn[k]);
    }
}

FrameStack stack_of(const ExposureGroup& group,
                    const PixelLayout& layout,
                    const FrameReader& read) {
    FrameStack stack;
    for (const capture::FrameRecord* frame : group.frames) {
        require_same(layout, *frame);
        stack.add(read(*frame));
    }
    return stack;
}

double mean_variance_dn2(const FrameStack& stack) {
    if (stack.count < 2)
        return 0.0;
    const float most = kMostOverMedian * median_of(stack.squares_dn2);
    double sum = 0.0;
    std::size_t used = 0;
    for (const float squares : stack.squares_dn2) {
        if (most > 0.0F && squares > most)
            continue;
        sum += squares;
        ++used;
    }
    return sum / static_cast<double>(used) / (stack.count - 1);
}

}  // namespace nearfield::calibrate
