#pragma once

namespace slam::plugin {

/// Makes the driver `SimulatedLidar` known to mrpt::hwdrivers::CGenericSensor::createSensor(): a robot that
/// explores a plan by itself, as a sensor for MRPT's programs. librasterslam-sensor.so calls this when it is
/// loaded (`rawlog-grabber -p librasterslam-sensor.so CONFIG.ini`).
///
/// Every doProcess() hands out one CObservationOdometry ("ODOMETRY", absolute, from the start) and one
/// CObservation2DRangeScan (label `sensorLabel`) with the same simulated stamp, 1/rate_hz after the one
/// before. Keys beside MRPT's own (driver, process_rate, max_queue_len, grab_decimation, sensorLabel): those
/// of ExploringRobotOptions. With real_time_factor > 0 the rate of the calls is real_time_factor times the
/// lidar's rate instead of process_rate. Errors: InputError from loadConfig() and initialize().
void registerSensors();

}  // namespace slam::plugin
