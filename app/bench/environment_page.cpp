// SPDX-License-Identifier: Apache-2.0
#include "app/bench/environment.h"
#include "app/bench/environment_plots.h"
#include "formats/files/provenance.h"
#include "formats/report/page.h"
#include "formats/report/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>

namespace nearfield::bench {
namespace {

struct StudyText {
    const char *study, *title, *paper, *here;
};

constexpr StudyText kStudies[] = {
    {"sphere", "Error against samples, on a sphere",
     "\"While both methods converge at a rate of N^-1/2, filtered BRDF IS has a lower RMS overall, "
     "especially on more glossy materials.\" \"The proposed filtering affords using only a small "
     "number of samples (40-50 in practice) for visually and numerically acceptable results.\" Of "
     "few samples and low-frequency BRDFs \"environment map importance sampling provides more "
     "pleasing images\" (sphere under Grace, 2008). How its RMS is defined it does not say.",
     "A ball of Phong's lobe. fis: the paper's; suns apart: small bright parts are summed one by "
     "one beside N samples, up to 32; gems: one level more, after its own clamp (2007); mfis: "
     "level by the "
     "density's mean over what a sample stands for (Tokuyoshi 2016); far lamps: "
     "N directions by luminance; resampled: N chosen of 8 N by what they would reflect; by error: "
     "as "
     "many as errors of 0.4, 0.2, 0.1, 0.05 are estimated to call for, N their mean. No shadows."},
    {"mesh", "The same on an uneven surface",
     "\"On complex geometry, undersampling appears as blurring and dulling of the highlights. "
     "However, visually acceptable results are found around 50 samples per pixel.\" More samples "
     "are required than on the sphere for the same RMS.",
     "The mesh named above."},
    {"counts", "As many samples as an error calls for",
     "\"We would like to find a heuristic to automatically choose the number of samples based on "
     "the "
     "properties of the BRDF, environment, and geometry\" (future work, 2008). \"24 or fewer "
     "samples "
     "are needed for surfaces with complex geometry. Smooth surfaces often need more\" (2007).",
     "The mesh, four camera samples a pixel, which count for each other where the surface turns "
     "within "
     "a pixel. By error: N by how far light varies over the lobe, at most 512; its mean is shown."},
    {"suns", "Small suns",
     "Nothing is said of suns that are smaller than what a sample stands for.",
     "A plate of GGX under darkness with one pixel of light, 40 samples. Light too much: of the "
     "sum; "
     "spark: the largest difference upwards over the mean."},
    {"anisotropic", "Brushed metal",
     "\"The isotropic filter approximation breaks down when rendering more anisotropic materials\" "
     "(Ward, 0.01 and 0.29). Filters by derivatives are \"almost always worse than with isotropic "
     "filtering, except for highly anisotropic BRDFs\", and ten times slower.",
     "A ball of Ward's lobe, brushed around its axis. Along the longer axis: up to 16 lookups."},
    {"visibility", "Shadows",
     "\"After 16 visibility samples, most of the error originates from the low-pass filter used to "
     "remove the spatial aliasing from the undersampled shadow maps\"; compared with a fit of "
     "10,000 samples, the best that such harmonics can do.",
     "The uneven surface, white and matt, on a floor, against traced samples. rays: the fit of so "
     "many directions by a ray each (the CPU); maps: by orthographic maps of 512 x 512 (OpenGL), "
     "coarse: "
     "of 64 x 64; over neighbors: means of 3 x 3 pixels of the same surface. "
     "The fit of most rays shows the harmonics' own error, maps less rays the maps'."},
    {"time", "Time on the graphics card against triangles",
     "\"Both times vary close to linearly with respect to the number of samples\" (figure 2).",
     "Least of three: rendering N maps, fitting them pixel by pixel, 40 filtered samples."}};

report::Section study_section(const EnvironmentFindings& findings, const StudyText& text) {
    report::Section section{text.title, {}, {}, {}, {}};
    section.paragraphs = {std::string("The paper: ") + text.paper,
                          std::string("Here: ") + text.here};
    if (std::string(text.study) != "suns")  // of one N
        add_plots(findings, text.study, section);
    report::Table table{"Errors against the traced reference",
                        {"", "method", "N", "relative RMS", "RMS over the mean", "RMS as displayed",
                         "mean Lab difference", "light too much", "spark", "time"},
                        {}};
    for (const EnvironmentRow& row : findings.rows)
        if (row.study == text.study)
            table.rows.push_back(
                {row.subject, row.method, fmt::format("{}", row.samples),
                 fmt::format("{:.3g}", row.rms), fmt::format("{:.3g}", row.rms_mean),
                 fmt::format("{:.3g}", row.rms_toned), fmt::format("{:.3g}", row.lab),
                 fmt::format("{:.2g} %", 100.0 * row.bias), fmt::format("{:.2g}", row.spark),
                 fmt::format("{:.3g} ms", 1e3 * row.time_s)});
    section.tables.push_back(std::move(table));
    return section;
}

/// A cube map beside the paraboloids.
report::Section maps_section(const EnvironmentFindings& findings) {
    report::Section section{"Paraboloid maps beside a cube map", {}, {}, {}, {}};
    section.paragraphs = {
        "The paper: \"We do not use cube maps since independent filtering of each face results in "
        "image artifacts (discontinuities).\"",
        "Here: what lookups show as the mean over a solid angle, against the mean over a cap of "
        "it, "
        "and how far they jump from one side to the other of where the two maps, or a cube's "
        "faces, "
        "meet; in shares of the picture's mean luminance. The picture without its suns; the cube's "
        "faces are half as wide as a paraboloid map, so that middle texels are about alike. Below, "
        "what a mirror shows about a cube's corner, which the paraboloids' seam passes too."};
    report::Table table{
        "Filtered lookups", {"", "solid angle", "RMS error", "RMS jump", "largest jump"}, {}};
    for (const MapRow& row : findings.maps)
        table.rows.push_back({row.map, fmt::format("{:g} sr", row.solid_angle_sr),
                              fmt::format("{:.3g}", row.error_rms),
                              fmt::format("{:.3g}", row.jump_rms),
                              fmt::format("{:.3g}", row.jump_most)});
    section.tables.push_back(std::move(table));
    for (const SeamPicture& seam : findings.seams) {
        report::HeatMap map;
        map.title = fmt::format("{}, {:g} sr", seam.map, seam.solid_angle_sr);
        map.value_label = "luminance";
        map.lower = {-1.0, -1.0};
        map.upper = {1.0, 1.0};
        map.size = glm::ivec2(seam.side_px);
        map.values = seam.luminance;
        map.high = *std::max_element(seam.luminance.begin(), seam.luminance.end());
        map.picture_px = {480, 420};
        if (const auto image = report::draw(map, map.title))
            section.images.push_back(*image);
    }
    section.columns = 2;
    return section;
}

bool is_measured(const EnvironmentFindings& findings, const std::string& study) {
    return std::any_of(findings.rows.begin(), findings.rows.end(),
                       [&](const EnvironmentRow& row) { return row.study == study; });
}

}  // namespace

void write_page(const EnvironmentFindings& findings,
                const EnvironmentSetup& setup,
                const std::string& path) {
    report::Page page;
    page.title = "What light from the environment costs and loses";
    page.summary =
        "Filtered samples, far lamps and fitted shadows against traced samples. Made by " +
        program_version() + ".";
    report::Section what{"What was measured", {}, {}, {}, {}};
    what.paragraphs = {
        fmt::format(
            "Light of {} on a ball and on {}, {} x {} pixels, against {} samples of sky and BRDF "
            "each, with a ray where there are shadows. \"reference\": two of those with other "
            "random numbers, so that what is below is noise. The paper: Krivanek and Colbert, "
            "Real-time shading with filtered importance sampling, 2008; what its text states is "
            "quoted, nothing is read off its plots.",
            findings.picture, findings.mesh, findings.frame_px, findings.frame_px,
            findings.reference_samples),
        "Relative RMS: of a/b - 1 where b is above a thousandth of the brightest. RMS over the "
        "mean: of a - b "
        "over b's mean. RMS as displayed: of 1 - exp(-L/mean). Lab: mean CIELAB difference of "
        "that."};
    if (setup.quick)
        what.paragraphs.emplace_back(
            "A quick run: small frames, noisy references, no conclusions.");
    page.sections = {what};
    report::Section claims{"What follows", conclusions(findings), {}, {}, {}};
    page.sections.push_back(claims);
    for (const StudyText& text : kStudies)
        if (is_measured(findings, text.study))
            page.sections.push_back(study_section(findings, text));
    if (!findings.maps.empty())
        page.sections.push_back(maps_section(findings));
    report::Section provenance{"Machine and command", {}, {}, {}, {}};
    provenance.preformatted =
        fmt::format("{}\n{}\n{}, {}\n{:.0f} s in all\n", setup.command_line, program_version(),
                    setup.machine, findings.device, findings.time_s);
    page.sections.push_back(provenance);
    report::write_page(page, path);
}

}  // namespace nearfield::bench
