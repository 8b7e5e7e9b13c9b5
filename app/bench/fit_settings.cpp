// SPDX-License-Identifier: Apache-2.0
#include "app/bench/fit_settings.h"

#include "formats/model/profile.h"

#include <fmt/format.h>

#include <type_traits>
#include <utility>

namespace nearfield::bench {
namespace {

template <typename Value, typename Apply>
void add(std::vector<FitSetting>& settings,
         const char* sweep,
         const char* text,
         const std::vector<Value>& values,
         const Apply& apply) {
    for (const Value& value : values) {
        FitSetting setting;
        setting.sweep = sweep;
        apply(setting, value);
        setting.setting = fmt::format(fmt::runtime(text), value);
        if constexpr (std::is_arithmetic_v<Value>)
            setting.value = static_cast<double>(value);
        settings.push_back(std::move(setting));
    }
}

void add_positions(bool quick, std::vector<FitSetting>& settings) {
    const std::vector<glm::ivec2> all =
        quick ? std::vector<glm::ivec2>{{5, 4}, {9, 7}}
              : std::vector<glm::ivec2>{{5, 4}, {7, 6}, {9, 7}, {11, 9}, {13, 11}, {16, 13}};
    for (const glm::ivec2 grid : all) {
        FitSetting setting;
        setting.sweep = "positions";
        setting.setting = fmt::format("{} x {}", grid.x, grid.y);
        setting.value = grid.x * grid.y;
        setting.grid = grid;
        settings.push_back(std::move(setting));
    }
}

template <typename Value>
std::vector<Value> ends(bool quick, std::vector<Value> values) {
    return quick ? std::vector<Value>{values.front(), values.back()} : values;
}

}  // namespace

std::vector<FitSetting> fit_settings(bool quick) {
    std::vector<FitSetting> settings;
    add_positions(quick, settings);
    add(settings, "missing", "{:g}", ends<double>(quick, {0, 0.05, 0.1, 0.2}),
        [](FitSetting& s, double share) { s.missing_share = share; });
    add(settings, "exposures", "{}", ends<int>(quick, {1, 2, 3, 4, 5}),
        [](FitSetting& s, int count) { s.exposures = count; });
    add(settings, "frames", "{}", ends<int>(quick, {1, 4, 16, 64}),
        [](FitSetting& s, int count) { s.frames = count; });
    add(settings, "filter", "{:g}", ends<double>(quick, {0.6, 0.8, 1, 1.25, 1.5}),
        [](FitSetting& s, double width) { s.filter_width = width; });
    add(settings, "basis", "{}", ends(quick, model::profile_names()),
        [](FitSetting& s, const std::string& basis) { s.basis = basis; });
    add(settings, "delta", "{:g} m", ends<double>(quick, {0.1, 0.2, 0.5, 1, 3}),
        [](FitSetting& s, double delta_m) { s.delta_m = delta_m; });
    add(settings, "lambda", "{:g}", ends<double>(quick, {1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1}),
        [](FitSetting& s, double lambda) { s.lambda = lambda; });
    add(settings, "model-error", "{:g}", ends<double>(quick, {0, 1e-3, 3e-3, 1e-2, 3e-2, 1e-1}),
        [](FitSetting& s, double error) { s.model_error_rel = error; });
    return settings;
}

}  // namespace nearfield::bench
