// SPDX-License-Identifier: Apache-2.0
#include "tests/render/gpu/gl_fixture.h"

namespace nearfield::render::gpu {

std::unique_ptr<HeadlessContext> GlTest::shared_context;
std::unique_ptr<Device> GlTest::shared_device;

void GlTest::SetUpTestSuite() {
    shared_context = std::make_unique<HeadlessContext>();
    shared_device = std::make_unique<Device>();
}

void GlTest::TearDownTestSuite() {
    shared_device.reset();
    shared_context.reset();
}

}  // namespace nearfield::render::gpu
