// SPDX-License-Identifier: Apache-2.0
#include "app/bench/environment.h"

#include "app/bench/environment_scenes.h"
#include "app/bench/environment_sweep.h"
#include "formats/files/provenance.h"

#include <algorithm>
#include <filesystem>

namespace nearfield::bench {
namespace {

void sweep_spheres(Sweep& sweep) {
    sweep_surfaces(sweep, make_ball(sweep.quick ? 24 : 64, 0.0),
                   sweep.quick ? std::vector{20.0F} : std::vector{5.0F, 20.0F, 100.0F, 500.0F},
                   "sphere");
}

void sweep_mesh(Sweep& sweep) {
    sweep_surfaces(sweep, sweep.mesh, sweep.quick ? std::vector{20.0F} : std::vector{20.0F, 100.0F},
                   "mesh");
}

struct Study {
    const char* name;
    void (*run)(Sweep&);
    double steps, quick_steps;  // about, for the progress line
};

constexpr Study kAllStudies[] = {{"sphere", sweep_spheres, 308, 23},
                                 {"mesh", sweep_mesh, 154, 23},
                                 {"counts", sweep_counts, 20, 20},
                                 {"anisotropic", sweep_brushed, 27, 27},
                                 {"suns", sweep_suns, 90, 30},
                                 {"maps", compare_maps, 3, 3},
                                 {"visibility", sweep_visibility, 18, 18},
                                 {"time", sweep_time, 12, 6}};

bool is_asked_for(const EnvironmentSweepOptions& options, const Study& study) {
    return options.studies.empty() || std::find(options.studies.begin(), options.studies.end(),
                                                study.name) != options.studies.end();
}

}  // namespace

std::vector<std::string> environment_studies() {
    std::vector<std::string> names;
    for (const Study& study : kAllStudies)
        names.emplace_back(study.name);
    return names;
}

EnvironmentFindings run_environment_sweeps(const EnvironmentSweepOptions& options,
                                           const std::function<void(double fraction)>& progress) {
    const double start_s = now_s();
    EnvironmentFindings findings;
    double done = 0.0, steps = 0.0;
    for (const Study& study : kAllStudies)
        if (is_asked_for(options, study))
            steps += options.quick ? study.quick_steps : study.steps;
    Sweep sweep{options.folder,
                options.picture,
                {},
                {},
                options.quick ? 256 : 2048,
                options.quick ? std::vector{8, 64} : std::vector{8, 16, 32, 50, 64, 128, 256, 512},
                options.quick,
                [&] { progress(std::min(++done / steps, 1.0)); },
                findings};
    if (sweep.picture.empty()) {
        sweep.picture = (std::filesystem::path(options.folder) / "hall.exr").string();
        write_hall(sweep.picture);
    }
    findings.picture = options.picture.empty() ? "a hall by formula" : options.picture;
    findings.mesh = options.mesh.empty() ? "a knobby ball" : options.mesh;
    sweep.mesh =
        options.mesh.empty() ? make_ball(options.quick ? 32 : 96, 0.08) : read_mesh(options.mesh);
    findings.frame_px = options.quick ? 24 : 48;
    findings.reference_samples = sweep.reference_samples;
    sweep.options.size_px = glm::ivec2(findings.frame_px);
    sweep.options.effects.shadows = render::Switch::Off;
    for (const Study& study : kAllStudies)
        if (is_asked_for(options, study))
            study.run(sweep);
    findings.time_s = now_s() - start_s;
    return findings;
}

}  // namespace nearfield::bench
