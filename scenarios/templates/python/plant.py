"""A tank in 20 lines: a valve fills it, and it leaks."""
try:
    from onescan_client import Input, Output, Simulation
except ModuleNotFoundError as missing:
    raise SystemExit(f"plant.py needs the package {missing.name}: type `pip install onescan`") from None


class Tank(Simulation):
    """A tank of 1 m³ with a valve."""

    Valve: Input[bool] = Input("BOOL")
    Level: Output[float] = Output("LREAL", 0.5)
    Full: Output[bool] = Output("BOOL")

    def step(self) -> None:
        inflow = 0.10 if self.Valve else 0.0
        self.Level = max(0.0, self.Level + (inflow - 0.02 * self.Level) * self.dt_s)
        self.Full = self.Level > 0.8


if __name__ == "__main__":
    Tank("plant").main()
