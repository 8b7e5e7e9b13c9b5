// SPDX-License-Identifier: Apache-2.0
#include "render/cpu/tracer.h"

#include "formats/files/error.h"
#include "formats/shared/sample_count.glsl.h"

#include <embree3/rtcore.h>
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

namespace nearfield::render {

struct Tracer::Embree {
    RTCDevice device = nullptr;
    RTCScene top = nullptr;
    std::vector<RTCScene> meshes;
    std::atomic<std::int64_t> bytes{0};

    Embree() = default;
    Embree(const Embree&) = delete;
    Embree& operator=(const Embree&) = delete;
    ~Embree() {
        for (RTCScene mesh : meshes)
            rtcReleaseScene(mesh);
        if (top != nullptr)
            rtcReleaseScene(top);
        if (device != nullptr)
            rtcReleaseDevice(device);
    }

    void check() const {
        if (const RTCError error = rtcGetDeviceError(device); error != RTC_ERROR_NONE)
            throw Error{"the ray tracer failed", "Embree", "",
                        fmt::format("error {}", static_cast<int>(error))};
    }
};

namespace {

RTCScene build_mesh(RTCDevice device, const Mesh& mesh) {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* positions = static_cast<float*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                sizeof(glm::vec3), mesh.positions_m.size()));
    auto* triangles = static_cast<unsigned*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                sizeof(glm::uvec3), mesh.triangles.size()));
    if (positions != nullptr && triangles != nullptr) {
        for (std::size_t i = 0; i < mesh.positions_m.size(); ++i)
            for (int axis = 0; axis < 3; ++axis)
                positions[3 * i + static_cast<std::size_t>(axis)] = mesh.positions_m[i][axis];
        for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
            for (int corner = 0; corner < 3; ++corner)
                triangles[3 * i + static_cast<std::size_t>(corner)] = mesh.triangles[i][corner];
    }
    rtcCommitGeometry(geometry);
    RTCScene scene = rtcNewScene(device);
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene);
    return scene;
}

void attach_instance(RTCDevice device,
                     RTCScene top,
                     RTCScene mesh,
                     const glm::dmat4& world_from_mesh,
                     std::uint32_t mask,
                     unsigned id) {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(geometry, mesh);
    const glm::mat4 matrix(world_from_mesh);
    rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR, &matrix[0][0]);
    rtcSetGeometryMask(geometry, mask);
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(top, geometry, id);
    rtcReleaseGeometry(geometry);
}

RTCRay make_ray(glm::vec3 origin, glm::vec3 direction, float length, std::uint32_t mask) {
    RTCRay ray{};
    ray.org_x = origin.x;
    ray.org_y = origin.y;
    ray.org_z = origin.z;
    ray.dir_x = direction.x;
    ray.dir_y = direction.y;
    ray.dir_z = direction.z;
    ray.tfar = length;
    ray.mask = mask;
    return ray;
}

/// Embree tells of memory taken (positive) and given back, from any thread; it may go on.
bool count_bytes(void* total, ssize_t bytes, bool) {
    *static_cast<std::atomic<std::int64_t>*>(total) += bytes;
    return true;
}

double largest(glm::dvec3 v) {
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

}  // namespace

Tracer::Tracer(const Scene& scene, const std::vector<std::uint32_t>& masks, int threads)
    : scene_(scene), embree_(std::make_unique<Embree>()) {
    embree_->device = rtcNewDevice(fmt::format("threads={}", threads).c_str());
    embree_->check();
    rtcSetDeviceMemoryMonitorFunction(embree_->device, count_bytes, &embree_->bytes);
    if (rtcGetDeviceProperty(embree_->device, RTC_DEVICE_PROPERTY_RAY_MASK_SUPPORTED) == 0)
        throw Error{"the ray tracer cannot leave meshes out", "Embree", "a build with ray masks",
                    "none"};
    for (const Mesh& mesh : scene.meshes)
        embree_->meshes.push_back(build_mesh(embree_->device, mesh));
    embree_->top = rtcNewScene(embree_->device);
    rtcSetSceneFlags(embree_->top, RTC_SCENE_FLAG_ROBUST);
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
        const Instance& instance = scene.instances[i];
        attach_instance(embree_->device, embree_->top,
                        embree_->meshes[static_cast<std::size_t>(instance.mesh)],
                        instance.world_from_mesh, masks[i], static_cast<unsigned>(i));
        normal_from_mesh_.push_back(
            glm::transpose(glm::inverse(glm::dmat3(instance.world_from_mesh))));
    }
    rtcCommitScene(embree_->top);
    embree_->check();
}

Tracer::~Tracer() = default;

double Tracer::bytes() const {
    return static_cast<double>(embree_->bytes.load());
}

std::optional<Hit> Tracer::trace(glm::dvec3 origin_world_m, glm::dvec3 direction_world) const {
    RTCRayHit query{};
    query.ray = make_ray(glm::vec3(origin_world_m), glm::vec3(direction_world),
                         std::numeric_limits<float>::infinity(), ~0U);
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    rtcIntersect1(embree_->top, &context, &query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID)
        return std::nullopt;

    // Meet the triangle's plane again in double: Embree's distance is exact to 1e-7 of the scene's
    // size only.
    const Instance& instance = scene_.instances[query.hit.instID[0]];
    const Mesh& mesh = scene_.meshes[static_cast<std::size_t>(instance.mesh)];
    const glm::uvec3 triangle = mesh.triangles[query.hit.primID];
    const auto corner = [&](unsigned index) {
        return glm::dvec3(instance.world_from_mesh * glm::dvec4(mesh.positions_m[index], 1.0));
    };
    const glm::dvec3 a = corner(triangle.x), b = corner(triangle.y), c = corner(triangle.z);
    const double u = static_cast<double>(query.hit.u), v = static_cast<double>(query.hit.v);
    Hit hit;
    hit.position_world_m = a + u * (b - a) + v * (c - a);
    hit.geometric_normal = glm::normalize(glm::cross(b - a, c - a));
    // Nearer to grazing the barycentric position is the better one.
    constexpr double kGrazing = 1e-3;
    const double cosine = glm::dot(hit.geometric_normal, direction_world);
    if (std::abs(cosine) > kGrazing)
        hit.position_world_m =
            origin_world_m +
            direction_world * (glm::dot(hit.geometric_normal, a - origin_world_m) / cosine);
    if (cosine > 0.0)
        hit.geometric_normal = -hit.geometric_normal;

    hit.shading_normal = hit.geometric_normal;
    if (!mesh.normals.empty()) {
        const glm::vec3 normal = mesh.normals[triangle.x] * (1.0F - query.hit.u - query.hit.v) +
                                 mesh.normals[triangle.y] * query.hit.u +
                                 mesh.normals[triangle.z] * query.hit.v;
        const glm::dvec3 world = normal_from_mesh_[query.hit.instID[0]] * glm::dvec3(normal);
        // Opposite vertex normals may cancel; the triangle's own serves there.
        if (const double length = glm::length(world); length > 0.0)
            hit.shading_normal = world / length;
        if (glm::dot(hit.shading_normal, hit.geometric_normal) < 0.0)
            hit.shading_normal = -hit.shading_normal;
    }

    if (!mesh.tangents.empty())
        hit.tangent = glm::dmat3(instance.world_from_mesh) *
                      glm::dvec3(mesh.tangents[triangle.x] * (1.0F - query.hit.u - query.hit.v) +
                                 mesh.tangents[triangle.y] * query.hit.u +
                                 mesh.tangents[triangle.z] * query.hit.v);

    // Embree subtracts corners from origins in float: its error is a few units in the last place of
    // the larger.
    constexpr double kUnits = 16.0 / 8388608.0;
    hit.offset_m =
        kUnits * std::max({largest(hit.position_world_m), largest(a - hit.position_world_m),
                           largest(b - hit.position_world_m), largest(c - hit.position_world_m)});
    hit.material = mesh.material;
    hit.instance = query.hit.instID[0];
    hit.triangle = query.hit.primID;
    return hit;
}

double Tracer::curvature(const Hit& hit) const {
    const Instance& instance = scene_.instances[hit.instance];
    const Mesh& mesh = scene_.meshes[static_cast<std::size_t>(instance.mesh)];
    if (mesh.normals.empty())
        return 0.0;
    const glm::uvec3 triangle = mesh.triangles[hit.triangle];
    const auto normal = [&](int corner) {
        return glm::vec3(glm::normalize(normal_from_mesh_[hit.instance] *
                                        glm::dvec3(mesh.normals[triangle[corner]])));
    };
    const auto edge_m = [&](int from, int to) {
        return glm::vec3(
            glm::dmat3(instance.world_from_mesh) *
            glm::dvec3(mesh.positions_m[triangle[to]] - mesh.positions_m[triangle[from]]));
    };
    return static_cast<double>(
        shared::triangle_curvature(edge_m(0, 1), edge_m(1, 2), normal(0), normal(1), normal(2)));
}

bool Tracer::is_occluded(glm::dvec3 from_world_m, glm::dvec3 to_world_m, std::uint32_t mask) const {
    // The ray ends this share of its length before its end, so that what carries the light does not
    // hide it.
    constexpr float kEnd = 1.0F - 1e-5F;
    RTCRay ray =
        make_ray(glm::vec3(from_world_m), glm::vec3(to_world_m - from_world_m), kEnd, mask);
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(embree_->top, &context, &ray);
    return ray.tfar < 0.0F;
}

bool Tracer::is_open(glm::dvec3 from_world_m, glm::dvec3 direction_world) const {
    RTCRay ray = make_ray(glm::vec3(from_world_m), glm::vec3(direction_world),
                          std::numeric_limits<float>::infinity(), ~0U);
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(embree_->top, &context, &ray);
    return ray.tfar >= 0.0F;
}

}  // namespace nearfield::render
