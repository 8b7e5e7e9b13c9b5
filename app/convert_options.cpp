// SPDX-License-Identifier: Apache-2.0
#include "app/convert_options.h"

#include "app/options.h"
#include "formats/model/profile.h"

namespace nearfield::app {

void add_convert_options(CLI::App& sub, ConvertCommand& c) {
    constexpr double kFar_mm = 1e6;
    sub.add_option("rays", c.input, "ray file: TM-25, Zemax, LightTools, Speos (docs/ray_files.md)")
        ->required()
        ->type_name("FILE");
    add_output(sub, c.output, "light field to write, NAME.lightfield.exr");
    const auto plane = [&](const char* name, std::optional<double>& z_mm, const char* help) {
        add_number(sub, name, z_mm, -kFar_mm, kFar_mm, "MM", help);
    };
    plane("--u-plane-mm", c.options.u_plane_mm,
          "basis plane of the slab towards +z, in the file's z; automatic by default");
    plane("--s-plane-mm", c.options.s_plane_mm,
          "image plane of the slab towards +z, in the file's z; automatic by default");
    add_size(sub, "--grid", c.options.grid, "basis functions of every slab; by default automatic");
    add_size(sub, "--texels", c.options.texels, "texels of every image; by default automatic");
    add_choice(sub, "--slabs", c.options.slabs,
               {{"1", std::optional(1)}, {"5", std::optional(5)}, {"6", std::optional(6)}},
               "directions: z > 0, all but mainly -z, all; by default the fewest that lose < 1 %");
    add_choice(sub, "--basis", c.options.basis, same_words(model::profile_names()),
               "shape of the basis functions");
    add_number(sub, "--flux-lm,--flux-w", c.flux, 1e-9, 1e12, "FLUX",
               "scale the rays to this total");
    sub.add_flag_callback(
        "--no-color", [&c] { c.options.color = false; }, "one channel Y even if rays have color");
    sub.add_flag("--keep-ray-flux", c.read.keep_ray_flux,
                 "keep the rays' own sum of flux where the file's header states another");
    sub.add_flag("--keep-radiometric", c.read.keep_radiometric,
                 "keep watts where wavelengths would give lumens");
    sub.add_flag("--allow-drop", c.allow_drop, "write even if over 2 % of the flux is lost");
    add_seed(sub, c.options.seed, "of cross-validation");
}

}  // namespace nearfield::app
