// SPDX-License-Identifier: Apache-2.0
#include "acquire/instrument_stage.h"

#include "acquire/gcode_stage.h"
#include "acquire/lamp_supply.h"
#include "formats/files/provenance.h"

#include <chrono>
#include <optional>
#include <thread>
#include <utility>

namespace nearfield::acquire {
namespace {

using capture::Shot;
using capture::ShotKind;

constexpr double kMmPerM = 1000;

// The meter, and what its readings mean.
struct Luxmeter {
    capture::LuxmeterPlan plan;
    Usbtmc instrument;

    explicit Luxmeter(const capture::LuxmeterPlan& luxmeter)
        : plan(luxmeter), instrument(luxmeter.device) {}
    double reading_lx() { return plan.lx_per_unit * instrument.number(plan.query); }
};

class InstrumentStage : public Stage {
  public:
    InstrumentStage(const capture::Plan& plan,
                    std::unique_ptr<Stage> hands,
                    const ShouldStop& should_stop);

    void arrange(const Shot& shot, const ShouldStop& should_stop) override;
    Readings readings() override;
    std::vector<std::string> instruments() override;

  private:
    void move_filter(glm::ivec2 position, const ShouldStop& should_stop);
    double watched();

    capture::Plan plan_;
    std::unique_ptr<Stage> hands_;
    std::optional<GcodeStage> motion_;
    std::optional<Luxmeter> luxmeter_;
    std::optional<LampSupply> supply_;
    glm::ivec2 position_{-1};  // where the filter stands
    glm::dvec2 stage_mm_{0};
};

InstrumentStage::InstrumentStage(const capture::Plan& plan,
                                 std::unique_ptr<Stage> hands,
                                 const ShouldStop& should_stop)
    : plan_(plan), hands_(std::move(hands)) {
    const capture::InstrumentsPlan& instruments = plan.instruments;
    if (instruments.luxmeter)
        luxmeter_.emplace(*instruments.luxmeter);
    if (instruments.supply)
        supply_.emplace(*instruments.supply);
    if (instruments.stage)
        motion_.emplace(instruments.stage->device, should_stop);
}

void InstrumentStage::move_filter(glm::ivec2 position, const ShouldStop& should_stop) {
    if (position == position_)
        return;
    position_ = glm::ivec2(-1);
    const capture::GcodeStagePlan& stage = *plan_.instruments.stage;
    const glm::dvec2 target_mm = stage.first_position_mm + kMmPerM * plan_.pitch_m *
                                                               glm::dvec2(position) *
                                                               glm::dvec2(stage.direction);
    stage_mm_ = motion_->move_to(target_mm, stage.feed_mm_per_min, stage.tolerance_mm, should_stop);
    for (const double end_s = now_s() + plan_.settle_s; now_s() < end_s;) {
        if (should_stop())
            throw Stopped{};
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    position_ = position;
}

// What tells whether the lamp is warm. Light is best, but a meter in the dark reads noise.
double InstrumentStage::watched() {
    const double light_lx = luxmeter_ ? luxmeter_->reading_lx() : 0;
    return light_lx > 0 ? light_lx : supply_->current_a();
}

void InstrumentStage::arrange(const Shot& shot, const ShouldStop& should_stop) {
    Shot left = shot;  // for hands
    if (motion_)
        left.position = glm::ivec2(-1);
    if (supply_ && shot.kind == ShotKind::Dark)
        left.kind = ShotKind::Light;  // the screen in its place; the lamp is ours
    hands_->arrange(left, should_stop);
    if (motion_ && shot.position.x >= 0)
        move_filter(shot.position, should_stop);
    if (supply_)
        supply_->set_lamp(
            shot.kind != ShotKind::Dark, [this] { return watched(); }, should_stop);
}

Readings InstrumentStage::readings() {
    Readings readings = hands_->readings();
    if (luxmeter_)
        readings.illuminance_lx = luxmeter_->reading_lx();
    if (supply_) {
        readings.lamp_voltage_v = supply_->voltage_v();
        readings.lamp_current_a = supply_->current_a();
    }
    if (motion_ && position_.x >= 0)
        readings.stage_mm = stage_mm_;
    return readings;
}

std::vector<std::string> InstrumentStage::instruments() {
    std::vector<std::string> list;
    if (motion_)
        list.push_back("stage: " + motion_->version());
    if (luxmeter_)
        list.push_back("luxmeter: " + luxmeter_->instrument.identity());
    if (supply_)
        list.push_back("supply: " + supply_->identity());
    return list;
}

}  // namespace

std::unique_ptr<Stage> instrument_stage(const capture::Plan& plan,
                                        std::unique_ptr<Stage> hands,
                                        const ShouldStop& should_stop) {
    return std::make_unique<InstrumentStage>(plan, std::move(hands), should_stop);
}

}  // namespace nearfield::acquire
