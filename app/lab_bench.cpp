// SPDX-License-Identifier: Apache-2.0
#include "app/lab_bench.h"

#include "app/progress.h"
#include "formats/files/error.h"

#include <fmt/format.h>

#include <memory>
#include <utility>

namespace nearfield::app {
namespace {

using capture::ShotKind;

/// What camera and stage share.
struct Lab {
    std::string path;
    sample_data::Prepared prepared;
    sample_data::Shot shot;

    const sample_data::Bench& bench() const { return sample_data::bench_of(*prepared); }
};

sample_data::Subject subject_of(ShotKind kind) {
    switch (kind) {
        case ShotKind::Target:
            return sample_data::Subject::Target;
        case ShotKind::Flat:
            return sample_data::Subject::Flat;
        case ShotKind::Filter:
            return sample_data::Subject::Filter;
        case ShotKind::Blocked:
            return sample_data::Subject::Blocked;
        case ShotKind::Dark:
        case ShotKind::Light:
        case ShotKind::Reference:
            break;
    }
    return sample_data::Subject::Position;
}

sample_data::Shot arranged(const capture::Shot& shot, const sample_data::Shot& before) {
    sample_data::Shot now = before;
    now.subject = subject_of(shot.kind);
    if (shot.position.x >= 0)
        now.position = shot.position;
    if (shot.view >= 0)
        now.target_view = shot.view;
    now.lamp_on = shot.kind != ShotKind::Dark;
    // As the network camera counts: noise depends on the plan's shot, not on what was taken before.
    now.frame_number = static_cast<std::uint64_t>(shot.number + 1) << 32U;
    return now;
}

class LabCamera : public acquire::Camera {
  public:
    explicit LabCamera(std::shared_ptr<Lab> lab) : lab_(std::move(lab)) {}

    acquire::CameraIdentity identity() const override {
        return {"nearfield", "virtual bench", "0", lab_->path};
    }

    void configure(const capture::CameraPlan& plan) override {
        const sample_data::BenchCamera& camera = lab_->bench().camera;
        const std::string format = fmt::format(
            "{}{}", camera.mosaic == sample_data::Mosaic::Mono ? "Mono" : "BayerRG", camera.bits);
        if (plan.pixel_format != format)
            throw Error{"pixel format", lab_->path, format, plan.pixel_format};
        if (plan.region_size_px.x > 0)
            throw Error{"region", lab_->path, "all of the sensor", "a part of it"};
        lab_->shot.gain_db = plan.gain_db;
        pixel_format_ = format;
    }

    double set_exposure(double exposure_us) override {
        return lab_->shot.exposure_us = exposure_us;
    }
    double gain_db() override { return lab_->shot.gain_db; }

    acquire::Exposed expose(const acquire::ShouldStop& should_stop) override {
        if (should_stop())
            throw acquire::Stopped{};
        lab_->shot.time_s += lab_->shot.exposure_us * 1e-6;
        acquire::Exposed exposed;
        exposed.frame.size_px = lab_->bench().camera.size_px;
        exposed.frame.bits = lab_->bench().camera.bits;
        exposed.frame.values = sample_data::expose(*lab_->prepared, lab_->shot);
        exposed.pixel_format = pixel_format_;
        exposed.camera_time_ns = static_cast<std::uint64_t>(lab_->shot.time_s * 1e9);
        exposed.frame_id = ++lab_->shot.frame_number;
        return exposed;
    }

    std::optional<double> temperature_c() override {
        return sample_data::sensor_c(lab_->bench(), lab_->shot.time_s);
    }

  private:
    std::shared_ptr<Lab> lab_;
    std::string pixel_format_;
};

class LabStage : public acquire::Stage {
  public:
    explicit LabStage(std::shared_ptr<Lab> lab) : lab_(std::move(lab)) {}

    void arrange(const capture::Shot& shot, const acquire::ShouldStop& /*should_stop*/) override {
        lab_->shot = arranged(shot, lab_->shot);
    }
    acquire::Readings readings() override {
        acquire::Readings readings;
        readings.illuminance_lx = sample_data::photometer_lx(*lab_->prepared, lab_->shot);
        return readings;
    }

  private:
    std::shared_ptr<Lab> lab_;
};

}  // namespace

acquire::Bench open_lab_bench(const std::string& path) {
    ProgressLine line("prepare bench");
    auto lab = std::make_shared<Lab>();
    lab->path = path;
    lab->prepared = sample_data::prepare(sample_data::read_bench(path),
                                         [&line](double fraction) { line.update(fraction); });
    line.finish();
    return {std::make_unique<LabCamera>(lab), std::make_unique<LabStage>(lab)};
}

}  // namespace nearfield::app
