// SPDX-License-Identifier: Apache-2.0
#include "acquire/camera_stage.h"

#include "acquire/settings.h"

#include <utility>

namespace nearfield::acquire {
namespace {

using capture::Shot;
using capture::ShotKind;

const char* subject_of(ShotKind kind) {
    switch (kind) {
        case ShotKind::Target:
            return "Target";
        case ShotKind::Flat:
            return "Flat";
        case ShotKind::Filter:
            return "Filter";
        case ShotKind::Blocked:
            return "Blocked";
        case ShotKind::Dark:
        case ShotKind::Light:
        case ShotKind::Reference:
            break;
    }
    return "Position";
}

class CameraStage : public Stage {
  public:
    explicit CameraStage(std::shared_ptr<Device> device)
        : device_(std::move(device)),
          counts_shots_(device_->has("LabShot")),
          has_photometer_(device_->has("LabPhotometer")),
          has_lamp_(device_->has("LabLampOn")) {}

    void arrange(const Shot& shot, const ShouldStop& should_stop) override;
    Readings readings() override;

  private:
    void set(const char* feature, int value);
    void show(const char* subject);
    double photometer_lx();

    std::shared_ptr<Device> device_;
    bool counts_shots_, has_photometer_, has_lamp_;
};

void CameraStage::set(const char* feature, int value) {
    checked(*device_, std::string("set ") + feature, [&](GError** error) {
        arv_device_set_integer_feature_value(device_->device(), feature, value, error);
    });
    const auto got = checked(*device_, std::string("read ") + feature, [&](GError** error) {
        return arv_device_get_integer_feature_value(device_->device(), feature, error);
    });
    check_taken(feature, value, static_cast<double>(got), 0);
}

void CameraStage::show(const char* subject) {
    checked(*device_, "set LabSubject", [&](GError** error) {
        arv_device_set_string_feature_value(device_->device(), "LabSubject", subject, error);
    });
}

void CameraStage::arrange(const Shot& shot, const ShouldStop& should_stop) {
    if (should_stop())
        throw Stopped{};
    const bool is_dark = shot.kind == ShotKind::Dark;
    if (has_lamp_)
        checked(*device_, "switch the lamp", [&](GError** error) {
            arv_device_set_boolean_feature_value(device_->device(), "LabLampOn",
                                                 is_dark ? FALSE : TRUE, error);
        });
    if (shot.position.x >= 0) {
        set("LabFilterX", shot.position.x);
        set("LabFilterY", shot.position.y);
    }
    if (shot.view >= 0)
        set("LabTargetView", shot.view);
    show(subject_of(shot.kind));
    if (counts_shots_)
        set("LabShot", shot.number + 1);
}

Readings CameraStage::readings() {
    Readings readings;
    if (has_photometer_)
        readings.illuminance_lx = photometer_lx();
    return readings;
}

double CameraStage::photometer_lx() {
    return checked(*device_, "read the photometer", [&](GError** error) {
        return arv_device_get_float_feature_value(device_->device(), "LabPhotometer", error);
    });
}

}  // namespace

std::unique_ptr<Stage> camera_stage(std::shared_ptr<Device> device) {
    if (!device->has("LabSubject"))
        return nullptr;
    return std::make_unique<CameraStage>(std::move(device));
}

}  // namespace nearfield::acquire
