// SPDX-License-Identifier: Apache-2.0
#include "sample_data/devices/test_bed.h"

#include "formats/files/error.h"

#include <sys/ioctl.h>

#include <utility>

namespace nearfield::devices {
namespace {

void check(GError* failure, const std::string& what, const std::string& where) {
    if (failure == nullptr)
        return;
    const std::string why = failure->message;
    g_error_free(failure);
    throw Error{what, where, "", why};
}

}  // namespace

TestBed::TestBed() : bed_(umockdev_testbed_new()) {}

std::string TestBed::root() const {
    gchar* path = umockdev_testbed_get_root_dir(bed_.get());
    std::string root = path;
    g_free(path);
    return root;
}

void TestBed::add(const std::string& description) {
    GError* failure = nullptr;
    umockdev_testbed_add_from_string(bed_.get(), description.c_str(), &failure);
    check(failure, "cannot add simulated device", description.substr(0, description.find('\n')));
}

Handle<UMockdevIoctlData> load_argument(UMockdevIoctlClient* client) {
    const gsize bytes = _IOC_SIZE(umockdev_ioctl_client_get_request(client));
    if (bytes == 0)
        return nullptr;
    return Handle<UMockdevIoctlData>(
        umockdev_ioctl_data_resolve(umockdev_ioctl_client_get_arg(client), 0, bytes, nullptr));
}

ClientRef::ClientRef(UMockdevIoctlClient* client)
    : weak_(new GWeakRef, [](GWeakRef* weak) {
          g_weak_ref_clear(weak);
          delete weak;
      }) {
    g_weak_ref_init(weak_.get(), client);
}

Handle<UMockdevIoctlClient> ClientRef::get() const {
    if (!weak_)
        return nullptr;
    return Handle<UMockdevIoctlClient>(
        static_cast<UMockdevIoctlClient*>(g_weak_ref_get(weak_.get())));
}

IoctlNode::IoctlNode(TestBed& bed, const std::string& path, AnswerIoctl answer)
    : bed_(bed), path_(path), answer_(std::move(answer)), base_(umockdev_ioctl_base_new()) {
    g_signal_connect(base_.get(), "handle-ioctl", G_CALLBACK(on_ioctl), this);
    GError* failure = nullptr;
    umockdev_testbed_attach_ioctl(bed.get(), path.c_str(), base_.get(), &failure);
    check(failure, "cannot answer for simulated device", path);
}

IoctlNode::~IoctlNode() {
    umockdev_testbed_detach_ioctl(bed_.get(), path_.c_str(), nullptr);
    g_signal_handlers_disconnect_by_data(base_.get(), this);
}

gboolean IoctlNode::on_ioctl(UMockdevIoctlBase* /*base*/,
                             UMockdevIoctlClient* client,
                             gpointer node) {
    static_cast<IoctlNode*>(node)->answer_(client);
    return TRUE;
}

}  // namespace nearfield::devices
