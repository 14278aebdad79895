// Two joints with SimpleFOC: each motor follows its angle, and the learned model feeds forward what gravity, inertia and friction take.
#include <LeastAction.h>
#include <SimpleFOC.h>

// CHANGE 1: the model: `model.sh m.postcard plan.postcard > model.c` beside this sketch, or an array of your own.
extern "C" const uint8_t machine_model[];
extern "C" const size_t machine_model_bytes;

// CHANGE 2: the motors' pole pairs, drivers and sensors. CHANGE 3: their torque constants, N m/A.
BLDCMotor shoulder(7), elbow(7);
BLDCDriver3PWM shoulder_driver(PA8, PA9, PA10, PB5), elbow_driver(PA0, PA1, PA2, PB4);
MagneticSensorSPI shoulder_sensor(AS5048_SPI, PB12), elbow_sensor(AS5048_SPI, PB1);
const float torque_constant[2] = {0.08f, 0.08f};

LeastAction machine;
BLDCMotor *const motors[2] = {&shoulder, &elbow};

static void begin(BLDCMotor &motor, BLDCDriver3PWM &driver, MagneticSensorSPI &sensor) {
    sensor.init();
    motor.linkSensor(&sensor);
    // CHANGE 4: the supply.
    driver.voltage_power_supply = 24;
    driver.init();
    motor.linkDriver(&driver);
    motor.torque_controller = TorqueControlType::estimated_current;
    motor.controller = MotionControlType::angle;
    motor.init();
    motor.initFOC();
}

void setup() {
    Serial.begin(115200);
    // A model that is refused feeds nothing forward; the motors follow without it.
    const leastaction_status status = machine.begin(machine_model, machine_model_bytes);
    if (status != LEASTACTION_STATUS_OK) Serial.println(leastaction_message(status));
    begin(shoulder, shoulder_driver, shoulder_sensor);
    begin(elbow, elbow_driver, elbow_sensor);
}

void loop() {
    // CHANGE 5: the motion: angles, and their accelerations.
    const float acceleration[2] = {0, 0};
    machine.feedForward(motors, acceleration, torque_constant);
    for (BLDCMotor *motor : motors) {
        motor->loopFOC();
        motor->move(0);
    }
}
