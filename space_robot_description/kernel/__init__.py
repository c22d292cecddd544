"""What compiled numbers are made of, for plant and laws alike: the decorators, small vectors, a model's joints."""
