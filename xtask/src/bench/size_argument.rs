use v1_gabor::Size;

/// A size as the command line gives it.
pub(super) fn size(text: &str) -> Result<Size, String> {
    let wrong = || format!("{text:?} is no size; write width x height, such as 1024x768");
    let (width, height) = text.split_once('x').ok_or_else(wrong)?;
    let number = |text: &str| {
        text.parse::<usize>()
            .ok()
            .filter(|n| (32..=8192).contains(n))
    };
    match (number(width), number(height)) {
        (Some(width), Some(height)) => Ok(Size { width, height }),
        _ => Err(format!("{}; each from 32 to 8192", wrong())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_read_and_refused() {
        assert_eq!(
            size("1024x768"),
            Ok(Size {
                width: 1024,
                height: 768
            })
        );
        for wrong in ["", "1024", "1024x", "x768", "0x768", "1024x-1", "9000x768"] {
            assert!(size(wrong).is_err(), "{wrong}");
        }
    }
}
