// SPDX-License-Identifier: Apache-2.0
// Shadows of the environment: their error, and what they take.
#include "app/bench/environment_scenes.h"
#include "app/bench/environment_sweep.h"
#include "render/gpu/render.h"

#include <fmt/format.h>

#include <algorithm>

namespace nearfield::bench {

using render::EnvironmentOptions;

// Diffuse light on the mesh and on the floor below it, so that all errors are harmonics' and
// visibility's.
void sweep_visibility(Sweep& sweep) {
    Scene scene = scene_of(sweep.mesh, matt(), sweep.picture);
    add_floor(scene);
    sweep.options.effects.shadows = render::Switch::Auto;
    const Subject subject = make_subject(sweep, std::move(scene), "visibility", "diffuse");
    const auto asked = [](int directions, int filter_px = 0) {
        EnvironmentOptions options;
        options.directions = directions;
        options.filter_px = filter_px;
        return options;
    };
    measure(sweep, subject, "no shadows", 0, asked(0));
    for (const int n : {8, 16, 64}) {
        measure(sweep, subject, "rays", n, asked(n));
        measure(sweep, subject, "maps", n, asked(n), true);
        measure(sweep, subject, "maps, over neighbors", n, asked(n, 1), true);
        EnvironmentOptions coarse = asked(n);
        coarse.map_px = 64;
        measure(sweep, subject, "coarse maps", n, coarse, true);
        coarse.filter_px = 1;
        measure(sweep, subject, "coarse maps, over neighbors", n, coarse, true);
    }
    // More say no more of the sky than its harmonics can hold.
    const int all = sweep.quick ? 256 : 10000;
    measure(sweep, subject, "rays", all, asked(all));
    sweep.options.effects.shadows = render::Switch::Off;
}

// On the graphics card, against samples and against triangles.
void sweep_time(Sweep& sweep) {
    const std::vector<int> rows = sweep.quick ? std::vector{12, 24} : std::vector{16, 50, 160, 500};
    for (const int count : rows) {
        const Mesh mesh = make_ball(count, 0.05);
        Scene scene = scene_of(mesh, phong(50.0F), sweep.picture);
        add_floor(scene);
        for (const int n : {8, 16, 64}) {
            render::RenderOptions options = sweep.options;
            options.effects.shadows = render::Switch::On;
            options.environment.directions = n;
            double least_s = 1e30;
            for (int k = 0; k < 3; ++k)
                least_s =
                    std::min(least_s, environment_s(render::render_gl(scene, options).report));
            EnvironmentRow row{"time", fmt::format("{} triangles", mesh.triangles.size()),
                               "maps and light", n};
            row.time_s = least_s;
            sweep.findings.rows.push_back(row);
            sweep.step();
        }
    }
}

}  // namespace nearfield::bench
