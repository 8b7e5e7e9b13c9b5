// SPDX-License-Identifier: Apache-2.0
#include "app/bench/fit.h"
#include "formats/files/provenance.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace nearfield::bench {
namespace {

nlohmann::ordered_json as_json(const FitResult& result) {
    const FitSetting& setting = result.setting;
    return {{"sweep", setting.sweep},
            {"setting", setting.setting},
            {"value", setting.value},
            {"positions", result.positions},
            {"lambda", result.lambda},
            {"noise_rms", result.noise_rms},
            {"basis_rms", result.basis_rms},
            {"total_rms", result.total_rms},
            {"flux_rel", result.flux_rel},
            {"coverage", result.coverage},
            {"chi_square", result.chi_square},
            {"kkt_worst", result.kkt_worst},
            {"factorizations", result.factorizations},
            {"texel_us", result.texel_us}};
}

}  // namespace

std::string as_csv(const FitFindings& findings) {
    std::string csv =
        "sweep,setting,value,positions,lambda,noise_rms,basis_rms,total_rms,flux_rel,coverage,"
        "chi_square,kkt_worst,factorizations,texel_us\n";
    for (const FitResult& result : findings.results)
        csv += fmt::format(
            "{},{},{:.9g},{},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},"
            "{:.9g}\n",
            result.setting.sweep, result.setting.setting, result.setting.value, result.positions,
            result.lambda, result.noise_rms, result.basis_rms, result.total_rms, result.flux_rel,
            result.coverage, result.chi_square, result.kkt_worst, result.factorizations,
            result.texel_us);
    return csv;
}

std::string as_json(const FitFindings& findings, const FitSetup& setup) {
    nlohmann::ordered_json json = {{"kind", "fit"},
                                   {"program", program_version()},
                                   {"command", setup.command_line},
                                   {"machine", setup.machine},
                                   {"quick", setup.quick},
                                   {"texels", {findings.texels.x, findings.texels.y}},
                                   {"receivers", findings.receivers},
                                   {"time_s", findings.time_s},
                                   {"results", nlohmann::ordered_json::array()},
                                   {"solvers", nlohmann::ordered_json::array()},
                                   {"wholes", nlohmann::ordered_json::array()}};
    for (const FitResult& result : findings.results)
        json["results"].push_back(as_json(result));
    for (const SolverTime& solver : findings.solvers.solvers)
        json["solvers"].push_back({{"name", solver.name},
                                   {"texel_us", solver.texel_us},
                                   {"times_ours", solver.times_ours},
                                   {"difference", solver.difference},
                                   {"texels", solver.texels}});
    for (const auto& [name, cost] : findings.solvers.wholes)
        json["wholes"].push_back({{"name", name},
                                  {"texels", cost.texels},
                                  {"channels", cost.channels},
                                  {"threads", cost.threads},
                                  {"wall_s", cost.wall_s},
                                  {"cpu_s", cost.cpu_s},
                                  {"texel_us", cost.texel_us},
                                  {"factorizations", cost.factorizations},
                                  {"free_coefficients", cost.free_coefficients},
                                  {"kkt_worst", cost.kkt_worst}});
    return json.dump(1) + "\n";
}

}  // namespace nearfield::bench
