// A window of GLFW, with our own callbacks: they only note what happened, in the order in which it did.
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>

#include "app/platform/context.h"
#include "core/scene/error.h"

namespace ivory {

namespace {

// Keys that are the same on every layout; letters, digits and signs go by what is printed on them.
Key key_of_token(int token) {
    if (token >= GLFW_KEY_A && token <= GLFW_KEY_Z)
        return static_cast<Key>(static_cast<int>(Key::a) + token - GLFW_KEY_A);
    if (token >= GLFW_KEY_0 && token <= GLFW_KEY_9)
        return static_cast<Key>(static_cast<int>(Key::digit0) + token - GLFW_KEY_0);
    if (token >= GLFW_KEY_KP_0 && token <= GLFW_KEY_KP_9)
        return static_cast<Key>(static_cast<int>(Key::digit0) + token - GLFW_KEY_KP_0);
    if (token >= GLFW_KEY_F1 && token <= GLFW_KEY_F12)
        return static_cast<Key>(static_cast<int>(Key::f1) + token - GLFW_KEY_F1);
    switch (token) {
        case GLFW_KEY_ESCAPE:
            return Key::escape;
        case GLFW_KEY_ENTER:
            return Key::enter;
        case GLFW_KEY_KP_ENTER:
            return Key::keypad_enter;
        case GLFW_KEY_TAB:
            return Key::tab;
        case GLFW_KEY_BACKSPACE:
            return Key::backspace;
        case GLFW_KEY_INSERT:
            return Key::insert;
        case GLFW_KEY_DELETE:
            return Key::del;
        case GLFW_KEY_SPACE:
            return Key::space;
        case GLFW_KEY_LEFT:
            return Key::left;
        case GLFW_KEY_RIGHT:
            return Key::right;
        case GLFW_KEY_UP:
            return Key::up;
        case GLFW_KEY_DOWN:
            return Key::down;
        case GLFW_KEY_HOME:
            return Key::home;
        case GLFW_KEY_END:
            return Key::end;
        case GLFW_KEY_PAGE_UP:
            return Key::page_up;
        case GLFW_KEY_PAGE_DOWN:
            return Key::page_down;
        case GLFW_KEY_MINUS:
            return Key::minus;
        case GLFW_KEY_EQUAL:
            return Key::equal;
        case GLFW_KEY_COMMA:
            return Key::comma;
        case GLFW_KEY_PERIOD:
            return Key::period;
        case GLFW_KEY_SLASH:
            return Key::slash;
        case GLFW_KEY_LEFT_SHIFT:
        case GLFW_KEY_RIGHT_SHIFT:
            return Key::shift;
        case GLFW_KEY_LEFT_CONTROL:
        case GLFW_KEY_RIGHT_CONTROL:
            return Key::control;
        case GLFW_KEY_LEFT_ALT:
        case GLFW_KEY_RIGHT_ALT:
            return Key::alt;
        case GLFW_KEY_LEFT_SUPER:
        case GLFW_KEY_RIGHT_SUPER:
            return Key::super;
        default:
            return Key::none;
    }
}

// GLFW's tokens for letters are places on an American keyboard; its names are what this layout has there.
Key key_of(int token, int scancode) {
    const bool printable = token >= GLFW_KEY_SPACE && token < GLFW_KEY_ESCAPE;
    if (printable && token != GLFW_KEY_SPACE) {
        const char* const name = glfwGetKeyName(token, scancode);
        if (name != nullptr && name[0] != '\0' && name[1] == '\0') {
            const char c = name[0];
            if (c >= 'a' && c <= 'z') return static_cast<Key>(static_cast<int>(Key::a) + c - 'a');
            if (c >= '0' && c <= '9')
                return static_cast<Key>(static_cast<int>(Key::digit0) + c - '0');
        }
    }
    return key_of_token(token);
}

std::string last_glfw_error() {
    const char* description = nullptr;
    glfwGetError(&description);
    return description == nullptr ? "" : description;
}

class GlfwContext final : public WindowContext {
  public:
    GlfwContext(WindowSize size, bool maximised, const std::string& title) {
        if (glfwInit() == GLFW_FALSE)
            throw Error("there is no display to open a window on (" + last_glfw_error() +
                        "); `ivory render SCENE -o OUT.png` draws without one, `ivory SCENE "
                        "--headless --screenshot OUT.png` runs the viewer in memory");
        glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
        glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
        glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
        glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
        glfwWindowHint(GLFW_SCALE_TO_MONITOR, GLFW_TRUE);
        glfwWindowHint(GLFW_DEPTH_BITS, 0);
        glfwWindowHint(GLFW_STENCIL_BITS, 0);
        glfwWindowHint(GLFW_MAXIMIZED, maximised ? GLFW_TRUE : GLFW_FALSE);
        glfwWindowHintString(GLFW_X11_CLASS_NAME, "ivory");
        if (GLFWmonitor* const monitor = glfwGetPrimaryMonitor()) {
            int x = 0, y = 0, width = 0, height = 0;
            glfwGetMonitorWorkarea(monitor, &x, &y, &width, &height);
            if (width > 0 && height > 0)
                size = {std::min(size.width, width), std::min(size.height, height)};
        }
        window_ = glfwCreateWindow(size.width, size.height, title.c_str(), nullptr, nullptr);
        if (window_ == nullptr) {
            const std::string why = last_glfw_error();
            glfwTerminate();
            throw Error("the display gives no window with OpenGL 3.3 (" + why +
                        "); `ivory render SCENE -o OUT.png` draws without one, `ivory SCENE "
                        "--headless --screenshot OUT.png` runs the viewer in memory");
        }
        glfwMakeContextCurrent(window_);
        glfwSwapInterval(1);
        try {
            gl_ = Gl::load([](const char* name) { return glfwGetProcAddress(name); });
        } catch (...) {
            close();
            throw;
        }
        glfwSetWindowUserPointer(window_, this);
        watch();
    }
    ~GlfwContext() override { close(); }

    const char* name() const override { return "GLFW"; }
    const Gl& gl() const override { return gl_; }
    WindowSize size() const override {
        WindowSize size;
        glfwGetFramebufferSize(window_, &size.width, &size.height);
        return size;
    }
    void present() override { glfwSwapBuffers(window_); }

    void wait_events(EventQueue& queue, double seconds) override {
        queue_ = &queue;
        if (seconds < 0)
            glfwWaitEvents();
        else if (seconds == 0)
            glfwPollEvents();
        else
            glfwWaitEventsTimeout(seconds);
        queue_ = nullptr;
    }
    void set_title(const std::string& title) override {
        glfwSetWindowTitle(window_, title.c_str());
    }
    WindowSize points() const override {
        WindowSize size;
        glfwGetWindowSize(window_, &size.width, &size.height);
        return size;
    }
    bool maximised() const override {
        return glfwGetWindowAttrib(window_, GLFW_MAXIMIZED) == GLFW_TRUE;
    }
    double scale() const override {
        float x = 1, y = 1;
        glfwGetWindowContentScale(window_, &x, &y);
        return std::max(1.0, static_cast<double>(std::max(x, y)));
    }
    void wake() override { glfwPostEmptyEvent(); }
    void set_cursor(Cursor cursor) override {
        if (cursor == cursor_) return;
        cursor_ = cursor;
        GLFWcursor*& shape = cursors_[static_cast<std::size_t>(cursor)];
        if (shape == nullptr)
            shape = glfwCreateStandardCursor(shapes[static_cast<std::size_t>(cursor)]);
        glfwSetCursor(window_, shape);
    }
    void set_clipboard(const std::string& text) override {
        glfwSetClipboardString(window_, text.c_str());
    }
    std::string clipboard() const override {
        const char* const text = glfwGetClipboardString(window_);
        return text == nullptr ? "" : text;
    }

  private:
    // in the order of Cursor
    static constexpr std::array shapes = {GLFW_ARROW_CURSOR,   GLFW_IBEAM_CURSOR,
                                          GLFW_HAND_CURSOR,    GLFW_CROSSHAIR_CURSOR,
                                          GLFW_HRESIZE_CURSOR, GLFW_VRESIZE_CURSOR};

    static GlfwContext& of(GLFWwindow* window) {
        return *static_cast<GlfwContext*>(glfwGetWindowUserPointer(window));
    }

    // GLFW calls back within wait_events only, but for what it finds out while a window is made.
    template <class SomeEvent>
    void note(SomeEvent event) {
        if (queue_ != nullptr) queue_->push(std::move(event));
    }

    void watch() {
        glfwSetCursorPosCallback(window_, [](GLFWwindow* window, double x, double y) {
            // GLFW's units are points of the screen
            WindowSize points;
            glfwGetWindowSize(window, &points.width, &points.height);
            const WindowSize pixels = of(window).size();
            if (points.width < 1 || points.height < 1) return;
            of(window).note(
                MouseMoved{{x * pixels.width / points.width, y * pixels.height / points.height}});
        });
        glfwSetCursorEnterCallback(window_, [](GLFWwindow* window, int entered) {
            if (entered == GLFW_FALSE) of(window).note(MouseLeft{});
        });
        glfwSetMouseButtonCallback(window_, [](GLFWwindow* window, int button, int action, int) {
            static_assert(static_cast<int>(MouseButton::right) == GLFW_MOUSE_BUTTON_RIGHT &&
                          static_cast<int>(MouseButton::middle) == GLFW_MOUSE_BUTTON_MIDDLE);
            if (button < static_cast<int>(mouse_button_count))
                of(window).note(
                    MouseButtonChanged{static_cast<MouseButton>(button), action == GLFW_PRESS});
        });
        glfwSetScrollCallback(window_, [](GLFWwindow* window, double x, double y) {
            of(window).note(WheelTurned{x, y});
        });
        glfwSetKeyCallback(
            window_, [](GLFWwindow* window, int token, int scancode, int action, int) {
                const Key key = key_of(token, scancode);
                if (key != Key::none)
                    of(window).note(KeyChanged{key, action != GLFW_RELEASE, action == GLFW_REPEAT});
            });
        glfwSetCharCallback(window_, [](GLFWwindow* window, unsigned int character) {
            of(window).note(TextTyped{static_cast<char32_t>(character)});
        });
        glfwSetDropCallback(window_, [](GLFWwindow* window, int count, const char** paths) {
            of(window).note(FilesDropped{{paths, paths + count}});
        });
        glfwSetFramebufferSizeCallback(window_, [](GLFWwindow* window, int width, int height) {
            of(window).note(Resized{{width, height}});
        });
        glfwSetWindowContentScaleCallback(window_, [](GLFWwindow* window, float, float) {
            of(window).note(Rescaled{of(window).scale()});
        });
        glfwSetWindowCloseCallback(window_, [](GLFWwindow* window) {
            glfwSetWindowShouldClose(window, GLFW_FALSE);  // the viewer asks first
            of(window).note(CloseRequested{});
        });
    }

    void close() {
        for (GLFWcursor* shape : cursors_)
            if (shape != nullptr) glfwDestroyCursor(shape);
        glfwDestroyWindow(window_);
        glfwTerminate();
    }

    GLFWwindow* window_ = nullptr;
    Gl gl_;
    EventQueue* queue_ = nullptr;
    Cursor cursor_ = Cursor::arrow;
    std::array<GLFWcursor*, shapes.size()> cursors_{};
};

}  // namespace

std::unique_ptr<WindowContext> open_window_context(WindowSize size, bool maximised,
                                                   const std::string& title) {
    return std::make_unique<GlfwContext>(size, maximised, title);
}

}  // namespace ivory
