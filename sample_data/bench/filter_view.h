// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sample_data/bench/prepared.h"

#include <vector>

namespace nearfield::sample_data {

/// The filter (plate) in a position, against an even source behind it, without the screen:
/// electrons per second, [row from the top][column], the pixel's own color. The radiance of a
/// sample is the source's times the mean transmission over the rectangle of the filter's plane that
/// stands for the sample's share of the pixel, as with boards.
/// Cost  512 x 512 pixels: 0.1 s of CPU. Pictures of many positions are not worth their memory.
std::vector<float> filter_picture(const Bench& bench,
                                  const Places& places,
                                  std::size_t position_index);

}  // namespace nearfield::sample_data
