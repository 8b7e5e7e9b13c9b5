// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "render/gpu/device.h"
#include "render/gpu/headless.h"

#include <gtest/gtest.h>

#include <memory>

namespace nearfield::render::gpu {

/// One headless context for all tests of a suite. Without one they fail: a machine that cannot
/// render by OpenGL has not tested the OpenGL renderer.
class GlTest : public testing::Test {
  protected:
    static void SetUpTestSuite();
    static void TearDownTestSuite();

    Device& device() { return *shared_device; }

  private:
    static std::unique_ptr<HeadlessContext> shared_context;
    static std::unique_ptr<Device> shared_device;
};

}  // namespace nearfield::render::gpu
