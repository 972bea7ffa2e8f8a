use egocentric_depth::equation_5;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("{} m behind the fixation point", equation_5(1.0, 0.27, 0.01)?);
    Ok(())
}
