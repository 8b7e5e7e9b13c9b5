// SPDX-License-Identifier: Apache-2.0
#include "acquire/v4l2_stage.h"

#include <utility>

namespace nearfield::acquire {
namespace {

using capture::ShotKind;

// As the network camera's LabSubject counts.
int subject_code(ShotKind kind) {
    switch (kind) {
        case ShotKind::Flat:
            return 2;
        case ShotKind::Target:
            return 3;
        case ShotKind::Filter:
            return 5;
        case ShotKind::Blocked:
            return 6;
        case ShotKind::Dark:
        case ShotKind::Light:
        case ShotKind::Reference:
            break;
    }
    return 0;
}

class V4l2Stage : public Stage {
  public:
    explicit V4l2Stage(std::shared_ptr<V4l2Device> device) : device_(std::move(device)) {}

    void arrange(const capture::Shot& shot, const ShouldStop& should_stop) override {
        if (should_stop())
            throw Stopped{};
        device_->set("lab_subject", subject_code(shot.kind));
        if (shot.view >= 0)
            device_->set("lab_target_view", shot.view);
        device_->set("lab_shot", shot.number + 1);
    }

  private:
    std::shared_ptr<V4l2Device> device_;
};

}  // namespace

std::unique_ptr<Stage> v4l2_stage(std::shared_ptr<V4l2Device> device) {
    if (!device->has("lab_subject"))
        return nullptr;
    return std::make_unique<V4l2Stage>(std::move(device));
}

}  // namespace nearfield::acquire
