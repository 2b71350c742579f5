"""The plant of the sheet metal shear (scenarios/shear), by kinematics alone: two rams, two sensors."""
from onescan_client import Input, Output, Simulation

SPEED_M_S = 0.25
ACCELERATION_M_S2 = 2.5


class Shear(Simulation):
    """Two actuators that move one blade."""

    Actuator_1_Up: Input[bool] = Input("BOOL")
    Actuator_1_Down: Input[bool] = Input("BOOL")
    Actuator_2_Up: Input[bool] = Input("BOOL")
    Actuator_2_Down: Input[bool] = Input("BOOL")
    Sensor_1: Output[bool] = Output("BOOL")
    Sensor_2: Output[bool] = Output("BOOL")
    Position_1: Output[float] = Output("LREAL", -0.05)
    Position_2: Output[float] = Output("LREAL", -0.05)

    def start(self) -> None:
        self.speed = [0.0, 0.0]

    def step(self) -> None:
        self.Position_1 += self._way(0, self.Actuator_1_Up, self.Actuator_1_Down)
        self.Position_2 += self._way(1, self.Actuator_2_Up, self.Actuator_2_Down)
        self.Sensor_1 = self.Position_1 >= -0.002
        self.Sensor_2 = self.Position_2 >= -0.002

    def _way(self, ram: int, up: bool, down: bool) -> float:
        """How far a ram moves in this step, on its ramp to the speed that it is given."""
        wanted = SPEED_M_S * (int(up) - int(down))
        most = ACCELERATION_M_S2 * self.dt_s
        before = self.speed[ram]
        self.speed[ram] += max(-most, min(most, wanted - before))
        return 0.5 * (before + self.speed[ram]) * self.dt_s


if __name__ == "__main__":
    Shear("plant").main()
