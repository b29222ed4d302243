#!/usr/bin/env Rscript
# gstat: kriging and sequential Gaussian simulation from the 40 nearest samples. The fractal's power variogram is not
# allowed for simulation, so both use the Matern model that equals it at short distances (at D = 2.3 within 4 % at one
# cell, 17 % at ten). A longer range would be closer and makes the simulation's matrices singular.
if (!all(vapply(c("gstat", "sp"), requireNamespace, TRUE, quietly = TRUE))) {
  cat("gstat or sp is not installed\n")
  quit(status = 77)
}
suppressMessages({
  library(sp)
  library(gstat)
})
setwd(commandArgs(trailingOnly = TRUE)[1])
problem <- scan("problem.txt", quiet = TRUE)
rows <- problem[1]; columns <- problem[2]; cell <- problem[3]
hurst <- 3 - problem[4]; amplitude <- problem[5]; noise <- problem[6]
samples <- read.table("samples.xyz", col.names = c("x", "y", "z"))
coordinates(samples) <- ~ x + y
grid <- expand.grid(x = (seq_len(columns) - 0.5) * cell, y = (seq_len(rows) - 0.5) * cell)
coordinates(grid) <- ~ x + y
range <- 100 * cell
sill <- amplitude^2 / 2 * gamma(1 + hurst) / gamma(1 - hurst) * (2 * range)^(2 * hurst)
model <- vgm(sill, "Mat", range, kappa = hurst, nugget = max(noise^2, 1e-12))
run <- function(name, ...) {
  seconds <- system.time(found <- krige(z ~ 1, samples, grid, model = model, nmax = 40, debug.level = 0, ...))[["elapsed"]]
  write(format(found[[1]], digits = 9), paste0(name, ".txt"), ncolumns = 1)
  write(seconds, paste0(name, ".seconds"))
}
run("gstat-kriging")
set.seed(1)
run("gstat-simulation", nsim = 1)
