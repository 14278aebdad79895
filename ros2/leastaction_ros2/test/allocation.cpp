// update allocates nothing: every allocation of the process is counted.
#include "robot.hpp"

// The sanitizer has malloc already, and calls hooks; its header is not where every compiler looks.
#if defined(__SANITIZE_ADDRESS__)
extern "C" int __sanitizer_install_malloc_and_free_hooks(
    void (*allocated)(const volatile void *, std::size_t), void (*freed)(const volatile void *));
#else
extern "C" {
void * __libc_malloc(std::size_t size);
void * __libc_calloc(std::size_t count, std::size_t size);
void * __libc_realloc(void * old, std::size_t size);
}
#endif

namespace {

std::size_t allocations = 0;

using namespace test;

/// Runs a mode for a second with references, and counts allocations of its updates alone.
void none(const std::string & files, const char * mode, bool wrong) {
    Robot robot(files + "/arm.postcard", joints(), {0.0, 0.4, -0.8, 0.0, 0.5, 0.0});
    Loop loop(robot, parameters(files, mode));
    loop.start();
    Controller::Point point;
    point.positions.assign(N, 0.25);
    std::size_t counted = 0;
    for (int tick = 0; tick < 400; tick++) {
        if (tick == 100) loop.controller.get_node()->publish("~/reference", point);
        if (wrong && tick == 200) robot.q[3] = std::nan("");
        const std::size_t before = allocations;
        const auto result = loop.update();
        counted += allocations - before;
        CHECK((result == return_type::ERROR) == (wrong && tick >= 200), "tick %d", tick);
        if (result == return_type::OK) robot.step();
    }
    CHECK(counted == 0, "%s: %zu allocations in 400 updates", mode, counted);
}

}  // namespace

#if defined(__SANITIZE_ADDRESS__)
static void count(const volatile void *, std::size_t) { allocations++; }
static void ignore(const volatile void *) {}
#else
extern "C" void * malloc(std::size_t size) {
    allocations++;
    return __libc_malloc(size);
}
extern "C" void * calloc(std::size_t count, std::size_t size) {
    allocations++;
    return __libc_calloc(count, size);
}
extern "C" void * realloc(void * old, std::size_t size) {
    allocations++;
    return __libc_realloc(old, size);
}
#endif

int main(int, char ** arguments) {
#if defined(__SANITIZE_ADDRESS__)
    CHECK(__sanitizer_install_malloc_and_free_hooks(count, ignore) != 0, "no hooks");
#endif
    const std::string files = arguments[1];
    const std::size_t before = allocations;
    { const leastaction_ros2::Model model(files + "/arm.postcard"); }
    CHECK(allocations > before, "the counter counts nothing");
    for (const char * mode : {"gravity", "computed_torque", "follow"}) {
        none(files, mode, false);
        none(files, mode, true);
    }
    std::puts("no update allocates");
}
