/* Simulink's own makes an S-function a MEX file; here drive.c calls it. */
#if !defined(S_FUNCTION_NAME) || S_FUNCTION_LEVEL != 2
#error "an S-function has a name and is of level 2"
#endif
