// SPDX-License-Identifier: Apache-2.0
#include "app/bench/environment.h"
#include "formats/files/provenance.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace nearfield::bench {

std::string as_csv(const EnvironmentFindings& findings) {
    std::string text =
        "study,subject,method,samples,rms,rms_mean,rms_toned,lab,bias,spark,time_s\n";
    for (const EnvironmentRow& row : findings.rows)
        text +=
            fmt::format("{},\"{}\",\"{}\",{},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g}\n",
                        row.study, row.subject, row.method, row.samples, row.rms, row.rms_mean,
                        row.rms_toned, row.lab, row.bias, row.spark, row.time_s);
    return text;
}

std::string as_json(const EnvironmentFindings& findings, const EnvironmentSetup& setup) {
    nlohmann::ordered_json json = {{"kind", "environment"},
                                   {"program", program_version()},
                                   {"command", setup.command_line},
                                   {"machine", setup.machine},
                                   {"device", findings.device},
                                   {"picture", findings.picture},
                                   {"mesh", findings.mesh},
                                   {"quick", setup.quick},
                                   {"frame_px", findings.frame_px},
                                   {"reference_samples", findings.reference_samples},
                                   {"time_s", findings.time_s},
                                   {"conclusions", conclusions(findings)},
                                   {"results", nlohmann::ordered_json::array()}};
    for (const EnvironmentRow& row : findings.rows)
        json["results"].push_back({{"study", row.study},
                                   {"subject", row.subject},
                                   {"method", row.method},
                                   {"samples", row.samples},
                                   {"rms", row.rms},
                                   {"rms_mean", row.rms_mean},
                                   {"rms_toned", row.rms_toned},
                                   {"lab", row.lab},
                                   {"bias", row.bias},
                                   {"spark", row.spark},
                                   {"time_s", row.time_s}});
    json["maps"] = nlohmann::ordered_json::array();
    for (const MapRow& row : findings.maps)
        json["maps"].push_back({{"map", row.map},
                                {"solid_angle_sr", row.solid_angle_sr},
                                {"error_rms", row.error_rms},
                                {"jump_rms", row.jump_rms},
                                {"jump_most", row.jump_most}});
    return json.dump(1) + "\n";
}

}  // namespace nearfield::bench
