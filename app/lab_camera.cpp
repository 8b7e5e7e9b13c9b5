// SPDX-License-Identifier: Apache-2.0
#include "app/lab_camera.h"

#include <cstdint>

namespace nearfield::app {
namespace {

sample_data::Subject subject_of(gige::Subject subject) {
    switch (subject) {
        case gige::Subject::Open:
            return sample_data::Subject::Open;
        case gige::Subject::Flat:
            return sample_data::Subject::Flat;
        case gige::Subject::Target:
            return sample_data::Subject::Target;
        case gige::Subject::Filter:
            return sample_data::Subject::Filter;
        case gige::Subject::Blocked:
            return sample_data::Subject::Blocked;
        case gige::Subject::Cap:
            return sample_data::Subject::Cap;
        case gige::Subject::Position:
            break;
    }
    return sample_data::Subject::Position;
}

sample_data::Shot shot_of(const gige::Stage& stage, double time_s) {
    sample_data::Shot shot;
    shot.subject = subject_of(stage.subject);
    shot.position = stage.filter;
    shot.target_view = stage.target_view;
    shot.lamp_on = stage.lamp_on;
    shot.time_s = time_s;
    return shot;
}

}  // namespace

gige::Lab lab_of(const sample_data::Prepared& prepared) {
    const sample_data::Bench& bench = sample_data::bench_of(*prepared);
    gige::Lab lab;
    lab.sensor_px = bench.camera.size_px;
    lab.sensor_bits = bench.camera.bits;
    lab.is_bayer = bench.camera.mosaic == sample_data::Mosaic::Rggb;
    lab.filter_grid = bench.filter.grid;
    lab.target_views = static_cast<int>(bench.targets.views.size());
    lab.can_open = lab.can_see_filter = bench.setup != sample_data::Setup::Direct;
    lab.black_level_dn = bench.camera.black_level_dn;
    lab.expose = [prepared](const gige::Exposure& exposure) {
        sample_data::Shot shot = shot_of(exposure.stage, exposure.time_s);
        shot.exposure_us = exposure.exposure_us;
        shot.gain_db = exposure.gain_db;
        shot.frame_number = std::uint64_t{exposure.stage.shot} << 32U | exposure.frame_number;
        return sample_data::expose(*prepared, shot);
    };
    lab.photometer_lx = [prepared](const gige::Stage& stage, double time_s) {
        return sample_data::photometer_lx(*prepared, shot_of(stage, time_s));
    };
    lab.sensor_c = [prepared](double time_s) {
        return sample_data::sensor_c(sample_data::bench_of(*prepared), time_s);
    };
    return lab;
}

}  // namespace nearfield::app
