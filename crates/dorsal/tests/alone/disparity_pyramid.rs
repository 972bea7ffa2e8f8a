use disparity_pyramid::{DisparityField, Validity};
use ndarray::Array2;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let plane = |value: f32| Array2::from_elem((4, 6), value);
    let valid = Array2::from_elem((4, 6), Validity::Valid);
    let field = DisparityField::new(plane(-3.0), plane(0.5), plane(1.0), valid)?;
    println!("{:?}, density {}", field.at(2, 1), field.density());
    Ok(())
}
