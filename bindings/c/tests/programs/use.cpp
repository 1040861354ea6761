// The C++ header: each class as it is meant to be used, and what it throws.
#include <stepscope.hpp>
#include <type_traits>

#include "check.h"

using namespace stepscope;

static_assert(!std::is_copy_constructible_v<Scenario> && std::is_nothrow_move_constructible_v<Scenario>);
static_assert(!std::is_copy_constructible_v<Run> && std::is_nothrow_move_assignable_v<Run>);
static_assert(!std::is_copy_constructible_v<Device> && std::is_nothrow_move_constructible_v<Device>);
static_assert(std::is_base_of_v<std::runtime_error, Error>);

template <typename Call>
Error thrown(Call call) {
    try {
        call();
    } catch (const Error &error) {
        return error;
    }
    CHECK(!"an error is thrown");
    std::abort();
}

static void runs() {
    auto scenario = Scenario::from_json("{}");
    const auto due = scenario.step_times();
    auto run = scenario.run();
    scenario = Scenario::from_preset("song-2021-one-turn");
    CHECK(due.size() == 3200 && run.summary().positions[0] == 3200);
    CHECK(run.digest() == "ed82c77232a01a3a");
    CHECK(run.edges().size() == run.summary().records && run.edges()[0].cycle == 0);
    std::uint64_t last = 0;
    for (const Edge &edge : run.edges()) {
        CHECK(edge.cycle >= last);
        last = edge.cycle;
    }
    const auto steps = run.steps();
    CHECK(steps.size() == 3200 && run.steps(1).empty() && !first_difference(steps, steps));
    CHECK(first_difference(due, {due.begin(), due.end() - 1}) == due.size() - 1);
    const Run moved = std::move(run);
    CHECK(moved.summary().positions[0] == 3200);
    moved.write_vcd("use_cpp.vcd");
    CHECK(std::remove("use_cpp.vcd") == 0);
    CHECK(thrown([&] { Scenario::from_json("{}").run(false).edges(); }).status() == STEPSCOPE_ORDER);
}

static void errors() {
    const auto refused = thrown([] { Scenario::from_json(R"({"clock_hz":3,"bus":{"slots":0}})").run(); });
    CHECK(refused.status() == STEPSCOPE_PROBLEMS && refused.problems().size() == 2);
    CHECK(refused.problems()[1].path == "bus.slots");
    CHECK(std::string(refused.what()).find("\nbus.slots: 0 is out of range; use 1 to 127") != std::string::npos);
    CHECK(thrown([] { Scenario::from_json({}); }).status() == STEPSCOPE_PROBLEMS);
    CHECK(thrown([] { Scenario::from_file("no/such/file"); }).status() == STEPSCOPE_FILE);
    const auto bare = thrown([] { Scenario::from_json("{}").run().summary(1); });
    CHECK(bare.status() == STEPSCOPE_RANGE && bare.problems().empty() && std::string(bare.what()) != "");
    auto one = Scenario::from_json("{}");
    const auto other = std::move(one);
    CHECK(thrown([&] { one.run(); }).status() == STEPSCOPE_NULL);
}

static void devices() {
    Device device;
    unsigned edges = 0;
    device.watch([&](Edge) { ++edges; });
    CHECK(device.cycles_until_event() == 0U && device.clock() != 0 && edges == 1);
    device.run_until(2000);
    device.write(STEPSCOPE_REG_ORDERS, 0x83);
    device.write(STEPSCOPE_REG_PUSH, 1);
    device.advance(device.cycles_until_event().value());
    Device moved = std::move(device);
    moved.run_until(60000);
    CHECK(moved.read(STEPSCOPE_REG_POSITION) == 3 && moved.summary().positions[0] == 3 && edges == 8);
    CHECK(!moved.cycles_until_event());
    CHECK(thrown([&] { moved.run_until(1); }).status() == STEPSCOPE_RANGE);

    Device loud(Scenario::from_json("{}"));
    loud.watch([](Edge) { throw std::length_error("enough"); });
    bool is_thrown = false;
    try {
        loud.clock();
    } catch (const std::length_error &) {
        is_thrown = true;
    }
    loud.watch(nullptr);
    CHECK(is_thrown && loud.clock() != 0);

    Device framed(Scenario::from_json(R"({"line":{"protocol":"framed","address":7}})"));
    framed.send(encode_frame({7, 4, {}}));
    const Frame reply = decode_frame(framed.receive(100000));
    CHECK(reply.address == 7 && reply.kind == 0x84 && reply.body.size() == 9);
    CHECK(framed.receive(1000).empty());
    CHECK(thrown([] { decode_frame({1, 2, 3}); }).status() == STEPSCOPE_RANGE);
}

int main() {
    runs();
    errors();
    devices();
    CHECK(stepscope_live() == 0);
    std::puts("the C++ header works");
}
