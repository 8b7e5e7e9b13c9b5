// SPDX-License-Identifier: Apache-2.0
#include "tests/render/gpu/gl_fixture.h"

namespace nearfield::render::gpu {

std::unique_ptr<HeadlessContext> GlTest::context_;
std::unique_ptr<Device> GlTest::device_;

void GlTest::SetUpTestSuite() {
    context_ = std::make_unique<HeadlessContext>();
    device_ = std::make_unique<Device>();
}

void GlTest::TearDownTestSuite() {
    device_.reset();
    context_.reset();
}

}  // namespace nearfield::render::gpu
