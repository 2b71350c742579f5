//! The program as it is, where Cargo lets this package's tests find it.

fn main() -> std::process::ExitCode {
    onescan::cli::main()
}
