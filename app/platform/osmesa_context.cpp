// OSMesa: Mesa's OpenGL drawn into plain memory, without a display or a window system. Gone from Mesa 25.1
// on, where EGL takes its place. The few names used are those of GL/osmesa.h, which need not be there.
#include <array>
#include <cstdint>
#include <vector>

#include "app/platform/context.h"
#include "app/platform/shared_library.h"
#include "core/scene/error.h"

namespace ivory {

namespace {

using OsmesaContextHandle = struct osmesa_context*;

constexpr int osmesa_format = 0x22, osmesa_depth_bits = 0x30, osmesa_stencil_bits = 0x31,
              osmesa_profile = 0x33, osmesa_core_profile = 0x34, osmesa_major_version = 0x36,
              osmesa_minor_version = 0x37;

class OsmesaContext final : public MemoryContext {
  public:
    explicit OsmesaContext(WindowSize size)
        : library_({"libOSMesa.so.8", "libOSMesa.so.6"}),
          make_current_(library_.function<MakeCurrent>("OSMesaMakeCurrent")),
          destroy_(library_.function<Destroy>("OSMesaDestroyContext")) {
        const std::array<int, 13> attributes = {osmesa_format,
                                                static_cast<int>(gl::rgba),
                                                osmesa_depth_bits,
                                                0,
                                                osmesa_stencil_bits,
                                                0,
                                                osmesa_profile,
                                                osmesa_core_profile,
                                                osmesa_major_version,
                                                3,
                                                osmesa_minor_version,
                                                3,
                                                0};
        handle_ =
            library_.function<Create>("OSMesaCreateContextAttribs")(attributes.data(), nullptr);
        if (handle_ == nullptr) throw Error("OSMesa gives no OpenGL 3.3 core context");
        try {
            bind(size);
            gl_ = Gl::load(library_.function<GetProcAddress>("OSMesaGetProcAddress"));
        } catch (...) {
            destroy_(handle_);
            throw;
        }
    }
    ~OsmesaContext() override {
        make_current_(nullptr, nullptr, gl::unsigned_byte, 0, 0);
        destroy_(handle_);
    }

    const char* name() const override { return "OSMesa"; }
    const Gl& gl() const override { return gl_; }
    WindowSize size() const override { return size_; }
    void resize(WindowSize size) override { bind(size); }

  private:
    using Create = OsmesaContextHandle(const int*, OsmesaContextHandle);
    using MakeCurrent = std::uint8_t(OsmesaContextHandle, void*, GlEnum, GlInt, GlInt);
    using Destroy = void(OsmesaContextHandle);
    using GetProcAddress = Gl::ProcAddress(const char*);

    void bind(WindowSize size) {
        std::vector<std::uint8_t> color(static_cast<std::size_t>(size.width) * size.height * 4);
        if (!make_current_(handle_, color.data(), gl::unsigned_byte, size.width, size.height))
            throw Error("OSMesa refuses a picture of " + std::to_string(size.width) + "x" +
                        std::to_string(size.height));
        color_ = std::move(color);
        size_ = size;
    }

    SharedLibrary library_;
    MakeCurrent* make_current_;
    Destroy* destroy_;
    OsmesaContextHandle handle_ = nullptr;
    std::vector<std::uint8_t> color_;  // the colour buffer itself; OSMesa keeps its address
    WindowSize size_;
    Gl gl_;
};

}  // namespace

std::unique_ptr<MemoryContext> open_osmesa_context(WindowSize size) {
    return std::make_unique<OsmesaContext>(size);
}

}  // namespace ivory
