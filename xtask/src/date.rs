use std::time::{SystemTime, UNIX_EPOCH};

/// Today's date in UTC, as `2024-02-29`.
pub(crate) fn today() -> String {
    // A clock before 1970 is a clock that nobody set.
    let since = SystemTime::now().duration_since(UNIX_EPOCH);
    of_day(since.map_or(0, |since| since.as_secs() / 86_400))
}

/// The Gregorian date of a number of days after 1970-01-01.
///
/// Counts from the first of March of year 0, so that the leap day ends its year; 400 years have
/// 146097 days.
fn of_day(day: u64) -> String {
    let day = day + 719_468;
    let era = day / 146_097;
    let of_era = day % 146_097;
    let year = (of_era - of_era / 1_460 + of_era / 36_524 - of_era / 146_096) / 365;
    let of_year = of_era - (365 * year + year / 4 - year / 100);
    // Months from March alternate 31 and 30 days, five of them 153.
    let from_march = (5 * of_year + 2) / 153;
    let day = of_year - (153 * from_march + 2) / 5 + 1;
    let month = if from_march < 10 {
        from_march + 3
    } else {
        from_march - 9
    };
    let year = 400 * era + year + u64::from(month <= 2);
    format!("{year:04}-{month:02}-{day:02}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn days_have_their_dates() {
        for (day, date) in [
            (0, "1970-01-01"),
            (58, "1970-02-28"),
            (59, "1970-03-01"),
            (11_016, "2000-02-29"),
            (11_017, "2000-03-01"),
            (19_782, "2024-02-29"),
            (20_088, "2024-12-31"),
            (47_540, "2100-02-28"),
            (47_541, "2100-03-01"),
        ] {
            assert_eq!(of_day(day), date);
        }
    }

    /// No date is given twice or left out: the day of the month grows by one or starts again.
    #[test]
    fn dates_follow_one_another() {
        let mut last: u64 = 31;
        for day in 0..60_000 {
            let of_month = of_day(day)[8..].parse().unwrap();
            assert!(
                of_month == last + 1 || (of_month == 1 && last >= 28),
                "{day}"
            );
            last = of_month;
        }
    }
}
