// SPDX-License-Identifier: Apache-2.0
#include "app/lab_closure.h"

#include "app/cutoff_line.h"
#include "fit/solve_capture.h"
#include "formats/model/luminaire.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace nearfield::app {
namespace {

// 1 ... 25 m away, over the beam's window, by the R2 sequence (Roberts 2018).
std::vector<glm::dvec3> receiver_places(double delta_m) {
    constexpr int kCount = 300;
    constexpr double kNear_m = 1, kFar_m = 25;
    const glm::dvec3 step(0.8191725133961645, 0.6710436067037893, 0.5497004779019703);
    std::vector<glm::dvec3> places;
    for (int k = 0; k < kCount; ++k) {
        const glm::dvec3 x = glm::fract(glm::dvec3(0.5) + (k + 1.0) * step);
        const double distance_m = kNear_m * std::pow(kFar_m / kNear_m, x.z);
        const glm::dvec2 tangent =
            glm::mix(0.9 * sample_data::kBeamMin, 0.9 * sample_data::kBeamMax, glm::dvec2(x));
        places.emplace_back(distance_m * tangent, distance_m - delta_m);
    }
    return places;
}

model::Receiver facing_lamp(glm::dvec3 at_slab_m, double delta_m) {
    return {at_slab_m, -glm::normalize(at_slab_m + glm::dvec3(0, 0, delta_m))};
}

double irradiance_lx(const LightField& lightfield, const model::Receiver& receiver) {
    return model::luminance(model::irradiance(lightfield, receiver));
}

double flux_lm(const LightField& lightfield) {
    return model::luminance(model::flux(lightfield));
}

// E d^2 from the middle of U.
double intensity(const ClosureReceiver& receiver, double delta_m) {
    const glm::dvec3 from_u_m = receiver.at_slab_m + glm::dvec3(0, 0, delta_m);
    return receiver.truth_lx * glm::dot(from_u_m, from_u_m);
}

std::vector<ClosureReceiver> lit_receivers(const LabTruth& truth, double delta_m) {
    constexpr double kDark = 0.01;  // of the largest intensity
    std::vector<ClosureReceiver> receivers;
    for (const glm::dvec3& place_m : receiver_places(delta_m))
        receivers.push_back({place_m});
    tbb::parallel_for(std::size_t{0}, receivers.size(), [&](std::size_t k) {
        receivers[k].truth_lx =
            true_irradiance_lx(truth, facing_lamp(receivers[k].at_slab_m, delta_m));
    });
    double most = 0;
    for (const ClosureReceiver& receiver : receivers)
        most = std::max(most, intensity(receiver, delta_m));
    std::erase_if(receivers, [&](const ClosureReceiver& receiver) {
        return intensity(receiver, delta_m) < kDark * most;
    });
    return receivers;
}

// Of value over reference, less one.
struct Deviation {
    double rms = 0, mean = 0;
};

template <typename Value, typename Reference>
Deviation deviation(const std::vector<ClosureReceiver>& receivers,
                    const Value& value,
                    const Reference& reference) {
    Deviation deviation;
    const auto count = static_cast<double>(receivers.size());
    for (const ClosureReceiver& receiver : receivers) {
        const double error = value(receiver) / reference(receiver) - 1;
        deviation.rms += error * error / count;
        deviation.mean += error / count;
    }
    deviation.rms = std::sqrt(deviation.rms);
    return deviation;
}

ErrorSource source_of(const std::string& what,
                      const LightField& lightfield,
                      const LightField& noise_free,
                      const std::vector<ClosureReceiver>& receivers,
                      double delta_m) {
    std::vector<ClosureReceiver> seen = receivers;
    tbb::parallel_for(std::size_t{0}, seen.size(), [&](std::size_t k) {
        seen[k].fitted_lx = irradiance_lx(lightfield, facing_lamp(seen[k].at_slab_m, delta_m));
    });
    const Deviation off = deviation(
        seen, [](const ClosureReceiver& r) { return r.fitted_lx; },
        [](const ClosureReceiver& r) { return r.noise_free_lx; });
    return {what, off.rms, off.mean, flux_lm(lightfield) / flux_lm(noise_free) - 1};
}

// Largest difference of two cut-off lines, degrees.
using FindLine = std::optional<double> (*)(const BeamScan& scan, double tangent_x);

double cutoff_error_deg(FindLine line, const BeamScan& seen, const BeamScan& truth) {
    const std::vector<double> places = cutoff_places();
    std::vector<double> error_deg(places.size(), 0.0);
    tbb::parallel_for(std::size_t{0}, places.size(), [&](std::size_t k) {
        const auto at = line(seen, places[k]), real = line(truth, places[k]);
        error_deg[k] = at && real ? glm::degrees(std::abs(std::atan(*at) - std::atan(*real))) : 90;
    });
    return *std::max_element(error_deg.begin(), error_deg.end());
}

void add_cutoff(const LabTruth& truth,
                double delta_m,
                const LightField& fitted,
                const LightField& noise_free,
                Closure& closure) {
    constexpr double kWall_m = 25;
    const auto on_wall = [&](double tangent_x, double tangent_y) {
        return facing_lamp(glm::dvec3(kWall_m * tangent_x, kWall_m * tangent_y, kWall_m - delta_m),
                           delta_m);
    };
    const auto scan = [&](const LightField& lightfield) {
        return [&on_wall, &lightfield](double x, double y) {
            return irradiance_lx(lightfield, on_wall(x, y));
        };
    };
    const BeamScan real = [&](double x, double y) {
        return true_irradiance_lx(truth, on_wall(x, y));
    };
    closure.cutoff_deg = cutoff_error_deg(edge_tangent, scan(fitted), real);
    closure.cutoff_basis_deg = cutoff_error_deg(edge_tangent, scan(noise_free), real);
    closure.cutoff_gradient_deg = cutoff_error_deg(gradient_tangent, scan(fitted), real);
}

void summarize(Closure& closure) {
    const auto fitted = [](const ClosureReceiver& r) { return r.fitted_lx; };
    const auto noise_free = [](const ClosureReceiver& r) { return r.noise_free_lx; };
    const auto truth = [](const ClosureReceiver& r) { return r.truth_lx; };
    closure.irradiance_rms = deviation(closure.receivers, fitted, noise_free).rms;
    closure.irradiance_rms_truth = deviation(closure.receivers, fitted, truth).rms;
    closure.basis_rms_truth = deviation(closure.receivers, noise_free, truth).rms;
    const auto covered = std::count_if(
        closure.receivers.begin(), closure.receivers.end(), [](const ClosureReceiver& r) {
            return std::abs(r.fitted_lx - r.noise_free_lx) <= 3 * r.sigma_lx;
        });
    closure.coverage_3sigma =
        static_cast<double>(covered) / static_cast<double>(closure.receivers.size());
}

}  // namespace

Closure closure_of(const LabTruth& truth,
                   double rig_delta_m,
                   const fit::RectifiedCapture& capture,
                   const fit::CaptureFitOptions& options,
                   const fit::CaptureFit& fit) {
    const TrueTexels texels = true_texels(truth, capture.planes);
    const auto fit_truth = [&](const fit::Optics& optics) {
        return fit_true_texels(texels, capture.planes, optics, fit.lambda, fit.model_error_rel);
    };
    const LightField noise_free = fit_truth(true_optics(truth));
    Closure closure;
    closure.lamp_factor = truth.lamp_factor;
    closure.receivers = lit_receivers(truth, rig_delta_m);
    tbb::parallel_for(std::size_t{0}, closure.receivers.size(), [&](std::size_t k) {
        ClosureReceiver& receiver = closure.receivers[k];
        const model::Receiver at = facing_lamp(receiver.at_slab_m, rig_delta_m);
        receiver.fitted_lx = irradiance_lx(fit.lightfield, at);
        receiver.noise_free_lx = irradiance_lx(noise_free, at);
        receiver.sigma_lx = model::irradiance_sigma_y(fit.lightfield, at);
    });
    summarize(closure);
    closure.flux_rel = flux_lm(fit.lightfield) / true_flux_lm(truth) - 1;
    closure.noise_free_flux_rel = flux_lm(noise_free) / true_flux_lm(truth) - 1;
    closure.delta_rel = rig_delta_m / true_delta_m(truth) - 1;
    add_cutoff(truth, rig_delta_m, fit.lightfield, noise_free, closure);

    fit::CaptureFitOptions same = options;
    same.lambda = fit.lambda;
    same.model_error_rel = fit.model_error_rel;
    same.replicates = 0;
    same.progress = {};
    const auto add = [&](const std::string& what, const LightField& lightfield) {
        closure.budget.push_back(
            source_of(what, lightfield, noise_free, closure.receivers, rig_delta_m));
    };
    add("all", fit.lightfield);
    add("the filter's places and profile, as calibrated", fit_truth(capture.optics));
    add("light of the texels, as measured",
        fit::solve_capture(capture, true_optics(truth), same).lightfield);
    return closure;
}

}  // namespace nearfield::app
