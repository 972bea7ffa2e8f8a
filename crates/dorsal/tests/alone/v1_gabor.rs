use ndarray::Array2;
use v1_gabor::{FilterBank, GaborParams, LumaImage, Size};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let size = Size { width: 32, height: 24 };
    let bank = FilterBank::plan(GaborParams { scales: 2, ..GaborParams::default() }, size)?;
    let bars = Array2::from_shape_fn(size.dim(), |(_, x)| (1.5 * x as f32).sin());
    let responses = bank.respond(&LumaImage::new(bars)?)?;
    println!("{}", responses.scales()[0].at(0, 16, 12));
    Ok(())
}
