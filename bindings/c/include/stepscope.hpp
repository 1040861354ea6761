// Stepscope for C++17, header only, over stepscope.h: objects that free themselves, and exceptions in the place of statuses.
//
//     const auto scenario = stepscope::Scenario::from_file("turn.json");
//     const auto run = scenario.run();
//     std::cout << run.summary().positions[0] << " steps, digest " << run.digest() << '\n';
//
// Every call that fails throws stepscope::Error. Objects are moved, never copied; one that was moved from may only be
// assigned to or destroyed, and any other call of it throws. Times are whole clock cycles; numbers of controllers, axes and
// channels count from 0.
#ifndef STEPSCOPE_HPP
#define STEPSCOPE_HPP

#include <array>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "stepscope.h"

namespace stepscope {

using Edge = stepscope_edge;
using Step = stepscope_step;
using Summary = stepscope_summary;

// A path, such as "bus.slots", and what is wrong there.
struct Problem {
    std::string path;
    std::string message;
};

// Why a call failed. what() has a line per problem, as the command prints them.
class Error : public std::runtime_error {
public:
    Error(stepscope_status status, const stepscope_error *error)
        : std::runtime_error(error != nullptr ? stepscope_error_text(error) : stepscope_status_text(status)),
          status_(status) {
        for (std::size_t index = 0; index < stepscope_error_count(error); ++index) {
            problems_.push_back({stepscope_error_path(error, index), stepscope_error_message(error, index)});
        }
    }

    // STEPSCOPE_PROBLEMS, STEPSCOPE_RANGE, …
    stepscope_status status() const noexcept { return status_; }

    // Empty if the call has no error of its own, only a status.
    const std::vector<Problem> &problems() const noexcept { return problems_; }

private:
    stepscope_status status_;
    std::vector<Problem> problems_;
};

namespace detail {

template <typename T, stepscope_status (*Free)(T *)>
struct Freed {
    void operator()(T *handle) const noexcept { Free(handle); }
};

template <typename T, stepscope_status (*Free)(T *)>
using Handle = std::unique_ptr<T, Freed<T, Free>>;

inline void check(stepscope_status status) {
    if (status != STEPSCOPE_OK) {
        throw Error(status, nullptr);
    }
}

// Calls with an error, and throws it.
template <typename Call>
void check_with(Call call) {
    stepscope_error *error = nullptr;
    const stepscope_status status = call(&error);
    const Handle<stepscope_error, stepscope_error_free> freed(error);
    if (status != STEPSCOPE_OK) {
        throw Error(status, error);
    }
}

// Asks for the count, then for the items.
template <typename T, typename Call>
std::vector<T> list(Call call) {
    std::size_t count = 0;
    call(static_cast<T *>(nullptr), std::size_t{0}, &count);
    std::vector<T> items(count);
    if (count > 0) {
        call(items.data(), items.size(), &count);
    }
    return items;
}

} // namespace detail

// Every edge of a controller, without a copy: valid as long as its run.
class Edges {
public:
    Edges(const Edge *first, std::size_t count) noexcept : first_(first), count_(count) {}
    const Edge *begin() const noexcept { return first_; }
    const Edge *end() const noexcept { return count_ > 0 ? first_ + count_ : first_; }
    std::size_t size() const noexcept { return count_; }
    bool empty() const noexcept { return count_ == 0; }
    const Edge &operator[](std::size_t index) const noexcept { return first_[index]; }

private:
    const Edge *first_;
    std::size_t count_;
};

// A run that has ended.
class Run {
public:
    explicit Run(stepscope_run *handle) noexcept : handle_(handle) {}

    Summary summary(std::uint32_t controller = 0) const {
        Summary summary = STEPSCOPE_SUMMARY;
        detail::check(stepscope_run_summary(get(), controller, &summary));
        return summary;
    }

    // 16 hexadecimal digits that identify all edges.
    std::string digest(std::uint32_t controller = 0) const {
        std::string text(16, '0');
        std::uint64_t rest = summary(controller).digest;
        for (auto digit = text.rbegin(); digit != text.rend(); ++digit, rest >>= 4) {
            *digit = "0123456789abcdef"[rest & 15];
        }
        return text;
    }

    Edges edges(std::uint32_t controller = 0) const {
        const Edge *first = nullptr;
        std::size_t count = 0;
        detail::check(stepscope_run_edges(get(), controller, &first, &count));
        return {first, count};
    }

    // The steps of a channel, in cycles since reset.
    std::vector<Step> steps(std::uint32_t channel = 0, std::uint32_t controller = 0) const {
        return detail::list<Step>([&](Step *out, std::size_t capacity, std::size_t *count) {
            detail::check(stepscope_run_steps(get(), controller, channel, out, capacity, count));
        });
    }

    // Writes a Value Change Dump, for GTKWave, Surfer and PulseView.
    void write_vcd(const std::string &path, std::uint32_t controller = 0) const {
        detail::check_with([&](stepscope_error **error) {
            return stepscope_run_write_vcd(get(), controller, path.c_str(), error);
        });
    }

    const stepscope_run *get() const noexcept { return handle_.get(); }

private:
    detail::Handle<stepscope_run, stepscope_run_free> handle_;
};

// A scenario: a motion, a host, a serial line, controllers.
class Scenario {
public:
    static Scenario from_json(std::string_view json) {
        return made([&](stepscope_scenario **out, stepscope_error **error) {
            // An empty view may have no address.
            const char *text = json.data() != nullptr ? json.data() : "";
            return stepscope_scenario_from_json(text, json.size(), out, error);
        });
    }

    static Scenario from_file(const std::string &path) {
        return made([&](stepscope_scenario **out, stepscope_error **error) {
            return stepscope_scenario_from_file(path.c_str(), out, error);
        });
    }

    static Scenario from_preset(const std::string &name) {
        return made([&](stepscope_scenario **out, stepscope_error **error) {
            return stepscope_scenario_from_preset(name.c_str(), out, error);
        });
    }

    // Runs from reset to the end. Without edges there is only the summary, and no limit of edges.
    Run run(bool edges = true) const {
        stepscope_run_options options = STEPSCOPE_RUN_OPTIONS;
        options.keep_edges = edges;
        stepscope_run *run = nullptr;
        detail::check_with([&](stepscope_error **error) {
            return stepscope_run_scenario(get(), &options, &run, error);
        });
        return Run(run);
    }

    // The steps of an axis as planned, in cycles from the start of the motion.
    std::vector<Step> step_times(std::uint32_t axis = 0, std::uint32_t controller = 0) const {
        return detail::list<Step>([&](Step *out, std::size_t capacity, std::size_t *count) {
            detail::check_with([&](stepscope_error **error) {
                return stepscope_step_times(get(), controller, axis, out, capacity, count, error);
            });
        });
    }

    const stepscope_scenario *get() const noexcept { return handle_.get(); }

private:
    explicit Scenario(stepscope_scenario *handle) noexcept : handle_(handle) {}

    template <typename Call>
    static Scenario made(Call call) {
        stepscope_scenario *scenario = nullptr;
        detail::check_with([&](stepscope_error **error) { return call(&scenario, error); });
        return Scenario(scenario);
    }

    detail::Handle<stepscope_scenario, stepscope_scenario_free> handle_;
};

// A controller alone, clocked by its caller; one call at a time.
class Device {
public:
    // With the defaults of a scenario.
    Device() : Device(nullptr, 0) {}
    explicit Device(const Scenario &scenario, std::uint32_t controller = 0) : Device(scenario.get(), controller) {}

    // Runs one cycle; returns the levels in it, as STEPSCOPE_LEVEL_ bits.
    std::uint64_t clock(bool line = true) {
        std::uint64_t levels = 0;
        call([&] { return stepscope_device_clock(get(), line, &levels); });
        return levels;
    }

    // Cycles without change while the line keeps its level; none if nothing can change any more.
    std::optional<std::uint64_t> cycles_until_event() const {
        std::uint64_t cycles = 0;
        detail::check(stepscope_device_cycles_until_event(get(), &cycles));
        return cycles == STEPSCOPE_NEVER ? std::nullopt : std::optional<std::uint64_t>(cycles);
    }

    void advance(std::uint64_t cycles) {
        call([&] { return stepscope_device_advance(get(), cycles); });
    }

    void run_until(std::uint64_t cycle, bool line = true) {
        call([&] { return stepscope_device_run_until(get(), cycle, line); });
    }

    void send(const std::vector<std::uint8_t> &bytes) {
        call([&] { return stepscope_device_send(get(), bytes.data(), bytes.size()); });
    }

    // The oldest reply that was not received yet; empty if none begins in time.
    std::vector<std::uint8_t> receive(std::uint64_t timeout_cycles) {
        std::array<std::uint8_t, 600> reply{};
        std::size_t count = 0;
        call([&] {
            return stepscope_device_receive(get(), timeout_cycles, reply.data(), reply.size(), &count);
        });
        return {reply.begin(), reply.begin() + static_cast<std::ptrdiff_t>(count)};
    }

    std::uint32_t read(std::uint32_t offset) const {
        std::uint32_t value = 0;
        detail::check(stepscope_device_read(get(), offset, &value));
        return value;
    }

    void write(std::uint32_t offset, std::uint32_t value) {
        call([&] { return stepscope_device_write(get(), offset, value); });
    }

    Summary summary() const {
        Summary summary = STEPSCOPE_SUMMARY;
        detail::check(stepscope_device_summary(get(), &summary));
        return summary;
    }

    // Calls `on_edge` for each edge from now on; an empty function ends that. What it throws is thrown by the call that
    // clocked the device, when that has done its work.
    void watch(std::function<void(Edge)> on_edge) {
        auto watcher = std::make_unique<Watcher>(Watcher{std::move(on_edge), nullptr});
        const bool is_set = static_cast<bool>(watcher->on_edge);
        detail::check(stepscope_device_watch(get(), is_set ? &Device::edge : nullptr, watcher.get()));
        watcher_ = std::move(watcher);
    }

    stepscope_device *get() noexcept { return handle_.get(); }
    const stepscope_device *get() const noexcept { return handle_.get(); }

private:
    struct Watcher {
        std::function<void(Edge)> on_edge;
        std::exception_ptr thrown;
    };

    Device(const stepscope_scenario *scenario, std::uint32_t controller) {
        stepscope_device *device = nullptr;
        detail::check_with([&](stepscope_error **error) {
            return stepscope_device_new(scenario, controller, &device, error);
        });
        handle_.reset(device);
    }

    static void edge(void *context, Edge edge) noexcept {
        auto *watcher = static_cast<Watcher *>(context);
        if (watcher->thrown != nullptr) {
            return;
        }
        try {
            watcher->on_edge(edge);
        } catch (...) {
            watcher->thrown = std::current_exception();
        }
    }

    template <typename Call>
    void call(Call call) {
        const stepscope_status status = call();
        if (watcher_ != nullptr && watcher_->thrown != nullptr) {
            std::rethrow_exception(std::exchange(watcher_->thrown, nullptr));
        }
        detail::check(status);
    }

    // The device is freed before its watcher: members go in the opposite order.
    std::unique_ptr<Watcher> watcher_;
    detail::Handle<stepscope_device, stepscope_device_free> handle_;
};

// The first index at which two lists differ: cycles more than `within` apart, another direction, or the end of one list.
inline std::optional<std::size_t> first_difference(const std::vector<Step> &expected, const std::vector<Step> &found,
                                                   std::uint64_t within = 0) {
    std::size_t index = 0;
    detail::check(stepscope_first_difference(expected.data(), expected.size(), found.data(), found.size(), within,
                                             &index));
    return index == STEPSCOPE_NONE ? std::nullopt : std::optional<std::size_t>(index);
}

// A frame of the framed protocol.
struct Frame {
    std::uint8_t address;
    std::uint8_t kind;
    std::vector<std::uint8_t> body;
};

// Encodes a frame with CRC, COBS and the closing 0x00.
inline std::vector<std::uint8_t> encode_frame(const Frame &frame) {
    return detail::list<std::uint8_t>([&](std::uint8_t *out, std::size_t capacity, std::size_t *count) {
        detail::check(stepscope_encode_frame(frame.address, frame.kind, frame.body.data(), frame.body.size(), out,
                                             capacity, count));
    });
}

// Decodes one frame; its closing 0x00 may be missing.
inline Frame decode_frame(const std::vector<std::uint8_t> &data) {
    Frame frame{};
    frame.body = detail::list<std::uint8_t>([&](std::uint8_t *out, std::size_t capacity, std::size_t *count) {
        detail::check(stepscope_decode_frame(data.data(), data.size(), &frame.address, &frame.kind, out, capacity,
                                             count));
    });
    return frame;
}

} // namespace stepscope

#endif
