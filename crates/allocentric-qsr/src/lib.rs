//! allocentric-qsr
