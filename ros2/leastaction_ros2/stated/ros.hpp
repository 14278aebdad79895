/// \file
/// Parts of rclcpp and rclcpp_lifecycle of Jazzy that the package uses, with the names and signatures of upstream, for tests on machines
/// without ROS 2. Never installed; a build in a ROS 2 workspace does not see it. Beyond upstream: Log, and LifecycleNode::publish.
#ifndef STATED__ROS_HPP_
#define STATED__ROS_HPP_

#include <any>
#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

namespace rclcpp {

namespace exceptions {

class InvalidParameterValueException : public std::runtime_error {
    using std::runtime_error::runtime_error;
};

class InvalidParameterTypeException : public std::runtime_error {
public:
    InvalidParameterTypeException(const std::string & name, const std::string message)
    : std::runtime_error("parameter '" + name + "' has invalid type: " + message) {}
};

class ParameterNotDeclaredException : public std::runtime_error {
    using std::runtime_error::runtime_error;
};

class ParameterUninitializedException : public std::runtime_error {
public:
    explicit ParameterUninitializedException(const std::string & name)
    : std::runtime_error("parameter '" + name + "' is not initialized") {}
};

class UnimplementedError : public std::runtime_error {
    using std::runtime_error::runtime_error;
};

}  // namespace exceptions

class Parameter {
public:
    using Value = std::variant<
        std::monostate, bool, std::int64_t, double, std::string, std::vector<double>, std::vector<std::int64_t>, std::vector<std::string>>;

    Parameter() = default;
    template <typename T>
    Parameter(const std::string & name, T value) : name_(name), value_(std::move(value)) {}

    const std::string & get_name() const { return name_; }

    template <typename T>
    const T & get_value() const {
        const T * value = std::get_if<T>(&value_);
        if (value == nullptr) throw exceptions::InvalidParameterTypeException(name_, "expected another type");
        return *value;
    }

    double as_double() const { return get_value<double>(); }
    const std::string & as_string() const { return get_value<std::string>(); }
    const std::vector<double> & as_double_array() const { return get_value<std::vector<double>>(); }
    const std::vector<std::string> & as_string_array() const { return get_value<std::vector<std::string>>(); }

private:
    std::string name_;
    Value value_;
};

class NodeOptions {
public:
    NodeOptions & parameter_overrides(const std::vector<Parameter> & overrides) {
        overrides_ = overrides;
        return *this;
    }
    const std::vector<Parameter> & parameter_overrides() const { return overrides_; }

private:
    std::vector<Parameter> overrides_;
};

namespace node_interfaces {

class NodeParametersInterface {
public:
    using SharedPtr = std::shared_ptr<NodeParametersInterface>;
    using ConstSharedPtr = std::shared_ptr<const NodeParametersInterface>;

    virtual ~NodeParametersInterface() = default;
    virtual bool has_parameter(const std::string & name) const = 0;
    virtual Parameter get_parameter(const std::string & name) const = 0;
    virtual bool get_parameter(const std::string & name, Parameter & parameter) const = 0;
};

}  // namespace node_interfaces

/// Lines that were logged, for tests.
struct Log {
    static std::vector<std::string> & lines() {
        static std::vector<std::string> lines;
        return lines;
    }
};

class Logger {
public:
    explicit Logger(const std::string & name) : name_(name) {}
    const char * get_name() const { return name_.c_str(); }

private:
    std::string name_;
};

__attribute__((format(printf, 2, 3))) inline void log(const Logger & logger, const char * format, ...) {
    char text[1024];
    va_list arguments;
    va_start(arguments, format);
    std::vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    Log::lines().push_back(std::string(logger.get_name()) + ": " + text);
}

#define RCLCPP_ERROR(logger, ...) rclcpp::log(logger, __VA_ARGS__)
#define RCLCPP_WARN(logger, ...) rclcpp::log(logger, __VA_ARGS__)

class Time {
public:
    explicit Time(std::int64_t nanoseconds = 0) : nanoseconds_(nanoseconds) {}
    std::int64_t nanoseconds() const { return nanoseconds_; }

private:
    std::int64_t nanoseconds_;
};

class Duration {
public:
    Duration(std::int32_t seconds, std::uint32_t nanoseconds) : nanoseconds_(seconds * std::int64_t{1000000000} + nanoseconds) {}
    std::int64_t nanoseconds() const { return nanoseconds_; }

private:
    std::int64_t nanoseconds_;
};

class QoS {};
class SystemDefaultsQoS : public QoS {};

template <typename Message>
class Subscription {
public:
    using SharedPtr = std::shared_ptr<Subscription>;
    explicit Subscription(std::function<void(const Message &)> callback) : callback_(std::move(callback)) {}
    void handle(const Message & message) const { callback_(message); }

private:
    std::function<void(const Message &)> callback_;
};

}  // namespace rclcpp

namespace rclcpp_lifecycle {

class State {};

namespace node_interfaces {

class LifecycleNodeInterface {
public:
    enum class CallbackReturn : std::uint8_t { SUCCESS = 97, FAILURE = 98, ERROR = 99 };

    virtual ~LifecycleNodeInterface() = default;
    virtual CallbackReturn on_configure(const State &) { return CallbackReturn::SUCCESS; }
    virtual CallbackReturn on_cleanup(const State &) { return CallbackReturn::SUCCESS; }
    virtual CallbackReturn on_shutdown(const State &) { return CallbackReturn::SUCCESS; }
    virtual CallbackReturn on_activate(const State &) { return CallbackReturn::SUCCESS; }
    virtual CallbackReturn on_deactivate(const State &) { return CallbackReturn::SUCCESS; }
    virtual CallbackReturn on_error(const State &) { return CallbackReturn::FAILURE; }
};

}  // namespace node_interfaces

/// A node that is its own NodeParametersInterface.
class LifecycleNode : public rclcpp::node_interfaces::NodeParametersInterface {
public:
    LifecycleNode(const std::string & name, const rclcpp::NodeOptions & options) : logger_(name) {
        for (const auto & parameter : options.parameter_overrides()) overrides_[parameter.get_name()] = parameter;
    }

    bool has_parameter(const std::string & name) const override { return parameters_.count(name) != 0; }

    rclcpp::Parameter get_parameter(const std::string & name) const override {
        rclcpp::Parameter found;
        if (!get_parameter(name, found)) throw rclcpp::exceptions::ParameterNotDeclaredException(name);
        return found;
    }

    bool get_parameter(const std::string & name, rclcpp::Parameter & parameter) const override {
        const auto found = parameters_.find(name);
        if (found == parameters_.end()) return false;
        parameter = found->second;
        return true;
    }

    template <typename T>
    T declare_parameter(const std::string & name, const T & value) {
        const auto given = overrides_.find(name);
        parameters_[name] = given == overrides_.end() ? rclcpp::Parameter(name, value) : given->second;
        return parameters_[name].template get_value<T>();
    }

    void set_parameter(const rclcpp::Parameter & parameter) { parameters_[parameter.get_name()] = parameter; }

    rclcpp::Logger get_logger() const { return logger_; }

    template <typename Message, typename Callback>
    typename rclcpp::Subscription<Message>::SharedPtr create_subscription(
        const std::string & topic, const rclcpp::QoS &, Callback && callback) {
        auto subscription = std::make_shared<rclcpp::Subscription<Message>>(std::forward<Callback>(callback));
        subscriptions_[topic] = std::weak_ptr<rclcpp::Subscription<Message>>(subscription);
        return subscription;
    }

    /// Hands a message to the subscription of a topic; false if there is none.
    template <typename Message>
    bool publish(const std::string & topic, const Message & message) {
        const auto found = subscriptions_.find(topic);
        if (found == subscriptions_.end()) return false;
        const auto alive = std::any_cast<std::weak_ptr<rclcpp::Subscription<Message>>>(found->second).lock();
        if (alive != nullptr) alive->handle(message);
        return alive != nullptr;
    }

private:
    rclcpp::Logger logger_;
    std::map<std::string, rclcpp::Parameter> overrides_, parameters_;
    std::map<std::string, std::any> subscriptions_;
};

}  // namespace rclcpp_lifecycle

#endif  // STATED__ROS_HPP_
