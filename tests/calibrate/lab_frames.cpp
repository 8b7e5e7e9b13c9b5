// SPDX-License-Identifier: Apache-2.0
#include "tests/calibrate/lab_frames.h"

#include "tests/sample_data/bench_small.h"

#include <algorithm>

namespace nearfield::test {
namespace {

sample_data::Shot shot_of(const LabFrames& lab, const capture::FrameRecord& record) {
    using capture::ShotKind;
    using sample_data::Subject;
    sample_data::Shot shot;
    const ShotKind kind = record.shot.kind;
    shot.subject = kind == ShotKind::Flat     ? Subject::Flat
                   : kind == ShotKind::Target ? Subject::Target
                   : kind == ShotKind::Filter ? Subject::Filter
                                              : Subject::Position;
    shot.position = record.shot.position;
    shot.target_view = record.shot.view;
    shot.lamp_on = kind != ShotKind::Dark;
    const auto real = lab.real_us.find(record.shot.exposure_us);
    shot.exposure_us = real == lab.real_us.end() ? record.shot.exposure_us : real->second;
    shot.time_s = static_cast<double>(record.time_us) * 1e-6;
    shot.frame_number = static_cast<std::uint64_t>(record.shot.number);
    return shot;
}

}  // namespace

LabFrames::LabFrames(const sample_data::Bench& bench) : prepared(sample_data::prepare(bench)) {}

void LabFrames::add(
    capture::ShotKind kind, double exposure_us, int count, glm::ivec2 position, int view) {
    const sample_data::Bench& bench = sample_data::bench_of(*prepared);
    for (int repeat = 0; repeat < count; ++repeat) {
        capture::FrameRecord record;
        record.shot.number = static_cast<int>(records.size());
        record.shot.kind = kind;
        record.shot.position = position;
        record.shot.view = view;
        record.shot.exposure_us = exposure_us;
        record.shot.repeat = repeat;
        record.file = capture::name_of(record.shot);
        record.size_px = bench.camera.size_px;
        record.bits = bench.camera.bits;
        record.pixel_format =
            bench.camera.mosaic == sample_data::Mosaic::Mono ? "Mono12" : "BayerRG12";
        record.exposure_us = exposure_us;
        record.time_us = 100000LL * record.shot.number;
        const sample_data::Shot shot = shot_of(*this, record);
        const capture::Frame frame = reader()(record);
        const capture::FrameLevels levels = capture::levels_of(frame);
        record.mean_dn = levels.mean_dn;
        record.share_saturated = levels.share_saturated;
        record.temperature_c = sample_data::sensor_c(bench, shot.time_s);
        record.reading_lx = sample_data::photometer_lx(*prepared, shot);
        records.push_back(record);
    }
}

calibrate::FrameReader LabFrames::reader() const {
    return [this](const capture::FrameRecord& record) {
        capture::Frame frame;
        frame.size_px = record.size_px;
        frame.bits = record.bits;
        frame.values = sample_data::expose(*prepared, shot_of(*this, record));
        return frame;
    };
}

capture::Capture LabFrames::capture() const {
    capture::Capture capture;
    for (const capture::FrameRecord& record : records)
        capture.frames[record.shot.number] = record;
    return capture;
}

std::vector<calibrate::ExposureGroup> LabFrames::groups(capture::ShotKind kind) const {
    std::vector<calibrate::ExposureGroup> groups;
    for (const capture::FrameRecord& record : records) {
        if (record.shot.kind != kind)
            continue;
        auto group = std::find_if(groups.begin(), groups.end(), [&](const auto& g) {
            return g.exposure_us == record.shot.exposure_us;
        });
        if (group == groups.end())
            group = groups.insert(groups.end(), {record.shot.exposure_us, {}});
        group->frames.push_back(&record);
    }
    return groups;
}

std::vector<calibrate::Bracket> LabFrames::brackets() const {
    std::map<std::pair<int, int>, calibrate::Bracket> by_position;
    for (const capture::FrameRecord& record : records) {
        if (record.shot.kind == capture::ShotKind::Light)
            by_position[{record.shot.position.x, record.shot.position.y}].push_back(&record);
    }
    std::vector<calibrate::Bracket> brackets;
    brackets.reserve(by_position.size());
    for (const auto& [position, bracket] : by_position)
        brackets.push_back(bracket);
    return brackets;
}

calibrate::PixelLayout LabFrames::layout() const {
    return calibrate::layout_of(records.front());
}

sample_data::Bench sensor_bench() {
    sample_data::Bench bench = small_bench();
    bench.camera.size_px = {96, 96};
    bench.camera.fx_px = 190;
    bench.camera.fy_px = 192;
    bench.camera.cx_px = 48.5;
    bench.camera.cy_px = 47.5;
    bench.camera.bits = 12;
    bench.camera.gain_e_per_dn = 2.7;
    bench.camera.full_well_e = 10500;
    bench.camera.read_noise_e = 5.5;
    bench.camera.black_level_dn = 48;
    bench.camera.dark_e_per_s = 40;
    bench.camera.prnu_sigma_rel = 0.01;
    bench.camera.dsnu_sigma_rel = 0.2;
    bench.camera.offset_sigma_dn = 0.6;
    bench.camera.hot_share = 0.001;
    bench.camera.hot_factor = 300;
    bench.flat_cd_m2 = 1000;  // 490,000 electrons per second
    bench.stray.veil_lx = 0;
    bench.accuracy.screen_step_px = 2;
    bench.accuracy.subsamples = 1;
    bench.accuracy.lens_step = 3;
    return bench;
}

}  // namespace nearfield::test
