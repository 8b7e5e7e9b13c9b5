// SPDX-License-Identifier: Apache-2.0
#include "formats/rays/export_rays.h"

#include "formats/files/error.h"
#include "formats/model/emission.h"
#include "formats/model/luminaire.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace nearfield::rays {
namespace {

constexpr std::uint64_t kRaysAtATime = 65536;

// The far end of a chord: the sphere holds the point.
glm::dvec3 on_sphere(glm::dvec3 point, glm::dvec3 direction, double radius) {
    const double along = glm::dot(point, direction);
    return point +
           direction *
               (std::sqrt(along * along + radius * radius - glm::dot(point, point)) - along);
}

struct FileFrame {
    glm::dmat3 rotation;
    glm::dvec3 origin_m;
};

Ray ray_of(const Slab& slab,
           const model::EmittedRay& emitted,
           const ExportOptions& options,
           const FileFrame& frame) {
    const glm::dvec3 s(emitted.s_m, 0.0), u(emitted.u_m, -slab.delta_m);
    const Rigid& pose = slab.luminaire_from_slab;
    const glm::dvec3 direction = pose.rotation * glm::normalize(s - u);
    glm::dvec3 start = pose.rotation * (options.start == RayStart::U ? u : s) + pose.translation_m;
    if (options.start == RayStart::Sphere)
        start = on_sphere(start, direction, options.sphere_radius_m);
    return {glm::vec3(frame.rotation * start + frame.origin_m),
            glm::vec3(glm::normalize(frame.rotation * direction)), 0.0F};
}

void check(const LightField& lightfield, const ExportOptions& options) {
    if (options.rays == 0)
        throw Error{"no rays asked for", "--rays", ">= 1", "0"};
    const double least_m = enclosing_radius_m(lightfield);
    if (options.start == RayStart::Sphere && !(options.sphere_radius_m >= least_m))
        throw Error{"the sphere does not hold the lamp", "--sphere-mm",
                    fmt::format(">= {:.4g} mm", 1e3 * least_m),
                    fmt::format("{:g} mm", 1e3 * options.sphere_radius_m)};
}

}  // namespace

glm::dmat3 file_from_luminaire(LightAxis axis) {
    const glm::dvec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
    switch (axis) {  // columns: where x, y and z go
        case LightAxis::PlusX:
            return {y, z, x};
        case LightAxis::MinusX:
            return {-y, z, -x};
        case LightAxis::PlusY:
            return {z, x, y};
        case LightAxis::MinusY:
            return {z, -x, -y};
        case LightAxis::PlusZ:
            return {x, y, z};
        case LightAxis::MinusZ:
            return {-x, y, -z};
    }
    return glm::dmat3(1.0);
}

double enclosing_radius_m(const LightField& lightfield) {
    double radius = 0.0;
    const auto add = [&radius](const Slab& slab, glm::dvec2 least, glm::dvec2 most, double z) {
        for (const double px : {least.x, most.x})
            for (const double py : {least.y, most.y})
                radius = std::max(
                    radius, glm::length(slab.luminaire_from_slab.rotation * glm::dvec3(px, py, z) +
                                        slab.luminaire_from_slab.translation_m));
    };
    for (const Slab& slab : lightfield.slabs) {
        const glm::dvec2 half_u =
            0.5 * (glm::dvec2(slab.grid - 1) + static_cast<double>(slab.profile.cells.size())) *
            slab.pitch_m;
        add(slab, slab.s_min_m, slab.s_max_m, 0.0);
        add(slab, slab.u_center_m - half_u, slab.u_center_m + half_u, -slab.delta_m);
    }
    return radius;
}

void export_rays(const LightField& lightfield,
                 const std::string& path,
                 const ExportOptions& options) {
    check(lightfield, options);
    const model::Emission emission(lightfield);
    const double flux = model::luminance(model::flux(lightfield));
    const FileFrame frame{file_from_luminaire(options.axis), options.origin_m};
    const bool has_color = options.has_color &&
                           std::any_of(lightfield.slabs.begin(), lightfield.slabs.end(),
                                       [](const Slab& slab) { return slab.channels == 3; }) &&
                           options.format == RayFormat::Tm25 &&
                           lightfield.quantity == Quantity::Photometric;
    RayWriter writer(path, {options.format, options.rays, lightfield.quantity, flux, has_color,
                            program_version() + " export"});
    const auto flux_per_ray = static_cast<float>(flux / static_cast<double>(options.rays));
    std::vector<Ray> rays;
    std::vector<glm::vec3> colors;
    for (std::uint64_t first = 0; first < options.rays; first += kRaysAtATime) {
        const std::uint64_t count = std::min(kRaysAtATime, options.rays - first);
        rays.resize(count);
        colors.resize(has_color ? count : 0);
        tbb::parallel_for(std::uint64_t{0}, count, [&](std::uint64_t k) {
            const model::EmittedRay emitted = emission.ray(first + k, options.seed);
            rays[k] = ray_of(lightfield.slabs[emitted.slab], emitted, options, frame);
            rays[k].flux = flux_per_ray;
            if (has_color)
                colors[k] = glm::vec3(emitted.color);
        });
        writer.add(rays, colors);
        if (options.progress)
            options.progress(static_cast<double>(first + count) /
                             static_cast<double>(options.rays));
    }
    writer.commit();
}

}  // namespace nearfield::rays
