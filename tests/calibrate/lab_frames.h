// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "calibrate/exposure_ratios.h"
#include "formats/capture/capture.h"
#include "sample_data/bench/bench.h"

#include <deque>
#include <map>
#include <vector>

namespace nearfield::test {

/// Frames of a virtual bench as a capture would list them, exposed when they are read.
struct LabFrames {
    sample_data::Prepared prepared;
    std::deque<capture::FrameRecord> records;
    /// Exposures that last another time than asked for: asked to real, us.
    std::map<double, double> real_us;

    explicit LabFrames(const sample_data::Bench& bench);

    void add(capture::ShotKind kind,
             double exposure_us,
             int count,
             glm::ivec2 position = glm::ivec2(0),
             int view = 0);
    calibrate::FrameReader reader() const;
    /// All of them, as a capture on disk would be read.
    capture::Capture capture() const;
    /// Frames of a kind by exposure, ascending.
    std::vector<calibrate::ExposureGroup> groups(capture::ShotKind kind) const;
    /// Light frames by position.
    std::vector<calibrate::Bracket> brackets() const;
    calibrate::PixelLayout layout() const;
};

/// A camera of 96 x 96 pixels before flats, boards and a 3 x 3 filter: everything that a sensor
/// does wrong is on.
sample_data::Bench sensor_bench();

}  // namespace nearfield::test
