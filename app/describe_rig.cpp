// SPDX-License-Identifier: Apache-2.0
#include "app/describe_rig.h"

#include <fmt/format.h>

#include <algorithm>

namespace nearfield::app {
namespace {

double sigma_of(const rig::Rig& rig, const std::string& name) {
    const auto found =
        std::find_if(rig.parameters.begin(), rig.parameters.end(),
                     [&](const rig::Parameter& parameter) { return parameter.name == name; });
    return found == rig.parameters.end() ? 0.0 : found->sigma;
}

std::string lens_text(const rig::Rig& rig) {
    const rig::Lens& lens = *rig.lens;
    std::string text = fmt::format(
        "lens       {} x {} px, focal length {:.2f} +- {:.2f} x {:.2f} +- {:.2f} px, center "
        "({:.2f}, "
        "{:.2f}) px, distortion",
        lens.size_px.x, lens.size_px.y, lens.fx_px, sigma_of(rig, "fx_px"), lens.fy_px,
        sigma_of(rig, "fy_px"), lens.cx_px, lens.cy_px);
    for (const double number : lens.distortion)
        text += fmt::format(" {:.3g}", number);
    return text + "\n";
}

std::string planes_text(const rig::Rig& rig) {
    const rig::Planes& planes = *rig.planes;
    return fmt::format(
        "planes     {:.3f} +- {:.3f} mm apart; {} x {} positions, pitch {:.4f} x {:.4f} mm\n",
        1e3 * planes.delta_m, 1e3 * sigma_of(rig, "delta_m"), planes.grid.x, planes.grid.y,
        1e3 * planes.pitch_m.x, 1e3 * planes.pitch_m.y);
}

std::string light_text(const rig::Radiometry& radiometry) {
    const std::string scale =
        radiometry.is_absolute
            ? fmt::format("{:.5g} lx for 1 DN/s, +- {:.2f} % random, +- {:.2g} % systematic",
                          radiometry.scale_lx_s_per_dn, 100 * radiometry.scale_sigma_rel,
                          100 * radiometry.scale_systematic_rel)
            : std::string("relative");
    return fmt::format(
        "sensor     {} bits, {}; {:.3f} e-/DN, read noise {:.2f} DN; values from {:.0f} DN on are "
        "not "
        "used\nlight      {}; the lens' veil {:.2f} %\n",
        radiometry.bits, radiometry.mosaic, radiometry.gain_e_per_dn, radiometry.read_noise_dn,
        radiometry.saturation_dn, scale, 100 * radiometry.veil_share);
}

}  // namespace

std::string rig_text(const rig::Rig& rig) {
    std::string text = fmt::format("kind       rig, format version {}\n", rig::kRigVersion);
    if (rig.lens)
        text += lens_text(rig);
    if (rig.planes)
        text += planes_text(rig);
    if (rig.radiometry)
        text += light_text(*rig.radiometry);
    return text + fmt::format("made by    {} {}, {} parameters with sigma\n",
                              rig.provenance.program, rig.provenance.command,
                              rig.parameters.size());
}

}  // namespace nearfield::app
