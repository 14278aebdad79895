//! Stamps as dates and times of day, in the notation of ISO 8601.

/// Days before each month of a year that is not a leap year.
const BEFORE_MONTH: [i64; 12] = [0, 31, 59, 90, 120, 151, 181, 212, 243, 273, 304, 334];

/// Reads `2024-05-01T12:00:00.25Z` as seconds since 1970. A blank may stand for T, and a comma for the point; without Z
/// or an offset such as `+02:00` the time is taken as universal. `None` if the text is anything else.
pub(crate) fn seconds(text: &str) -> Option<f64> {
    let (date, time) = text.split_at_checked(10)?;
    let days = days(date)?;
    let time = time.strip_prefix(['T', 't', ' '])?;
    let (time, ahead) = zone(time)?;
    let (whole, fraction) = time.split_once(['.', ',']).unwrap_or((time, "0"));
    let [hour, minute, second] = numbers(whole, ':', [2, 2, 2])?;
    let fraction: f64 = format!("0.{}", digits(fraction)?).parse().ok()?;
    let is_time = hour < 24 && minute < 60 && second <= 60;
    let seconds = 86_400 * days + 3600 * hour + 60 * minute + second - ahead;
    is_time.then_some(seconds as f64 + fraction)
}

/// Days from the first of 1970 to a date of the Gregorian calendar.
fn days(date: &str) -> Option<i64> {
    let [year, month, day] = numbers(date, '-', [4, 2, 2])?;
    let before = BEFORE_MONTH.get(usize::try_from(month).ok()?.checked_sub(1)?)?;
    let is_leap = year % 4 == 0 && (year % 100 != 0 || year % 400 == 0);
    let last = year - 1;
    let leap_days = last / 4 - last / 100 + last / 400 - 477 + i64::from(is_leap && month > 2);
    (1..=31).contains(&day).then_some(365 * (year - 1970) + leap_days + before + day - 1)
}

/// A time of day without its zone, and the seconds by which its clock is ahead of universal time.
fn zone(time: &str) -> Option<(&str, i64)> {
    if let Some(time) = time.strip_suffix(['Z', 'z']) {
        return Some((time.trim_end(), 0));
    }
    let Some(at) = time.find(['+', '-']) else { return Some((time, 0)) };
    let (time, offset) = time.split_at(at);
    let (sign, offset) = (if offset.starts_with('-') { -1 } else { 1 }, &offset[1..]);
    let [hours, minutes] = match offset.len() {
        2 => [numbers(offset, ':', [2])?[0], 0],
        4 => [numbers(&offset[..2], ':', [2])?[0], numbers(&offset[2..], ':', [2])?[0]],
        _ => numbers(offset, ':', [2, 2])?,
    };
    Some((time.trim_end(), sign * (3600 * hours + 60 * minutes)))
}

/// Numbers with these counts of digits, between separators.
fn numbers<const N: usize>(text: &str, separator: char, lengths: [usize; N]) -> Option<[i64; N]> {
    let mut parts = text.split(separator);
    let mut found = [0; N];
    for (number, length) in found.iter_mut().zip(lengths) {
        let part = parts.next().filter(|part| part.len() == length)?;
        *number = digits(part)?.parse().ok()?;
    }
    parts.next().is_none().then_some(found)
}

/// The text, if it has nothing but digits, and at least one.
fn digits(text: &str) -> Option<&str> {
    (!text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit())).then_some(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_are_seconds_since_1970() {
        assert_eq!(seconds("1970-01-01T00:00:00Z"), Some(0.0));
        assert_eq!(seconds("2024-02-29T12:00:00.25Z"), Some(1_709_208_000.25));
        assert_eq!(seconds("2024-03-01 00:00:00"), Some(1_709_251_200.0));
        assert_eq!(seconds("2000-01-01T00:00:00,5"), Some(946_684_800.5));
        for text in ["2024-05-01T14:00:00+02:00", "2024-05-01T06:30:00-0530", "2024-05-01 14:00:00 +02"] {
            assert_eq!(seconds(text), Some(1_714_564_800.0), "{text}");
        }
    }

    #[test]
    fn other_text_is_no_date() {
        for text in [
            "",
            "2024-05-01",
            "12:00:00",
            "2024-13-01T00:00:00",
            "2024-05-01T24:00:00",
            "2024-05-01T1:00:00",
            "1234567890.125",
            "2024-05-01T00:00:00.x",
            "ä024-05-01T00:00:00",
            "2024-05-01T00:00:00+é1",
        ] {
            assert_eq!(seconds(text), None, "{text}");
        }
    }
}
