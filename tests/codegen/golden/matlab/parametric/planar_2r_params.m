function params = planar_2r_params()
%PLANAR_2R_PARAMS  The parameters, with their values in the description.
%#codegen
params.m1 = 1.0;
params.m2 = 1.0;
params.l1 = 1.0;
params.lc1 = 0.5;
params.lc2 = 0.5;
params.I1 = 0.1;
params.I2 = 0.1;
params.g0 = 9.81;
params.l2 = 1.0;
end
